#ifndef TESTS_HARD_ROBOTS_H
#define TESTS_HARD_ROBOTS_H
/* Robots that are numerically hard, as texts of URDF: NUL-terminated, the same at every call; the caller frees them. */

/* A chain of links of 1 kg whose axes are z, y, z, y, ..., 0.1 m apart. */
char *robot_chain(int joints);

/* Eight links of 0.2 m whose masses are a geometric sequence from `first` to `last` kg. */
char *robot_masses(double first, double last);

/* Three pairs of coaxial joints, 0.3 m apart: a rotor in each, and what is turned against it. */
char *robot_rotors(void);

/* A beam on an axle with two equal arms left and right, one the other turned by half a turn about the axle. */
char *robot_balance(void);

/* Six joints, z, x, y, z, x, y, whose frames stand `slide` metres up their own axes, there and back by turns: whatever
   `slide` is, the same robot. */
char *robot_slid(double slide);

/* The same six joints, turned by rpy of 1.57, -1.5708 and 3.1416 as people write right angles. */
char *robot_right_angles(void);

/* Six joints about axes that are 1e-7 rad from parallel, one after the other. */
char *robot_parallel(void);

/* Six joints of a robot of the given size and density scale: lengths by `length`, masses by `mass`. */
char *robot_scaled(double length, double mass);

/* Seven joints about skew axes between frames turned by any angles; full inertias. Seed 11. */
char *robot_skew(void);

/* A hub that turns, and around it `arms` equal arms, each with a joint of its own. */
char *robot_star(int arms);

/* An arm of 100 kg in six links of 0.4 m, and on its tip a finger of 1 g and 3 cm. */
char *robot_finger(void);

/* Six joints of ordinary links; the last one's link has 1e-8 kg m^2 about its axis. */
char *robot_needle(void);

/* A base of 1000 kg, to be floated, with an arm of three links of 1 g. */
char *robot_satellite(void);

#endif
