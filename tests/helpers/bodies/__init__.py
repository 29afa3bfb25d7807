"""Bodies with limbs and parts with joints for the tests of cuts."""
