"""Constants of the method that were fitted or set by hand, with neighbouring values to compare them with."""
