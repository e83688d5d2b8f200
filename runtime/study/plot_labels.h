#ifndef RUNTIME_PLOT_LABELS_H
#define RUNTIME_PLOT_LABELS_H
/* Where labels stand in a picture: one for each cluster of points, clear of points, lines and each other. */

#include "study/study.h"

/* Pixels are counted from the lower left corner of the frame. */
struct plot_point {
	const struct study_row *row;
	double x, y;
	size_t cluster; /* private */
};

struct plot_line {
	double x[2], y[2];
};

/* A line leads from its points to the end of the text that is nearer. */
struct plot_label {
	char text[128];
	double x, y;       /* the middle of its points */
	double at_x, at_y; /* the end of the text, at half its height */
	int ends_there;    /* else it begins there */
};

/* Fill `labels`, which has room for one of each point; *label_count is how many there are. Points of one backend and
   precision that all but touch share one. Returns 0 if a frame of this size, in pixels, has no clear place for all of them:
   then the rest stand beside their points whatever is there. */
int plot_place(struct plot_label *labels, size_t *label_count, struct plot_point *points, size_t count,
	const struct plot_line *lines, size_t line_count, double width, double height);

#endif
