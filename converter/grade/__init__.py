"""`whitted grade`: strangers' programs run within limits, their pictures judged, a report of it."""
