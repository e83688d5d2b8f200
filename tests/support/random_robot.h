#ifndef TESTS_RANDOM_ROBOT_H
#define TESTS_RANDOM_ROBOT_H

#include <stdbool.h>
#include <stdint.h>

// What a random robot may look like. Numbers without a unit are probabilities.
struct random_robot_knobs {
	int links;		// at least 1
	double branching;	// a link hangs on any earlier link, else on the one before it
	double fixed, continuous, prismatic, floating, planar;	// type of a joint; revolute is the rest
	double mimic;		// a one-axis joint follows an earlier one, which may follow another
	double odd_axis;	// a general axis of any length; else along a coordinate axis, of either sign
	double right_rpy, general_rpy;	// angles of multiples of pi/2, any angles; the rest zero
	double bare;		// a link without <inertial>
	double massless;	// mass 0 and inertia 0
	double points;		// a mass without extent
	double rotated;		// an inertial with rpy
	double odd_names;	// C keywords, comment ends, '.', '-', blanks, UTF-8, quotes
	bool root_mass;		// the root link has an inertial
	bool shuffled;		// links and joints in random places of the file
};

// Every knob drawn from the seed: at most `links` links, all that URDF offers.
struct random_robot_knobs random_robot_knobs(uint64_t seed, int links);

// The text of a valid URDF, NUL-terminated, the same for the same seed and knobs; the caller frees it. Inertias are
// those of real mass distributions. With more than one link at least one joint moves.
char *random_robot(uint64_t seed, const struct random_robot_knobs *knobs);

#endif
