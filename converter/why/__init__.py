"""Why a picture of a scene differs from the right one: the mistakes that lead to it, found by making them."""
