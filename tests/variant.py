"""The Mitsuba variant that the tests run in, by `pytest --variant`."""

VARIANT = "llvm_ad_rgb"
