#ifndef TRACE_H
#define TRACE_H
/* What a control loop left behind, tick by tick; looked at when the loop is over. */

#include "plant.h"

struct record {
	double error[N];  /* rad: reference less measured */
	double tau[N];	  /* N m */
	double effort[N]; /* tau as a part of the joint's limit */
	double seconds;	  /* that the controller took */
	int limited;	  /* 1: a torque was held at its limit */
};

struct summary {
	double median, most, worst; /* seconds per call: half, 99.9 % and all of them took no longer */
	double error;		    /* rad, the largest from tick `settled` on */
	double effort;		    /* the largest part of a limit */
	int limited;		    /* ticks */
};

struct summary trace_summary(const struct record *records, size_t count, size_t settled);

/* Columns: seconds, tracking error of each joint in mrad, torque of each joint as a part of its limit. Returns 1 if the
   file cannot be written. */
int trace_write(const char *path, const struct record *records, size_t count, double rate);

#endif
