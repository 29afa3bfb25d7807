"""How much congruent parts may deviate from each other, in diagonals of the box of the first one."""

# Set by hand: a sphere of 320 faces deviates by 0.004 from one of 5,120, and a leg that is longer by 2 % by 0.01.
TOLERANCE = 0.01
LARGEST_TOLERANCE = 0.1
