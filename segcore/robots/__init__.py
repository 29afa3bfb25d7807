"""Parts as the links of a robot, for simulators: masses, joints, convex pieces for collisions."""
