#include "study/plot_labels.h"
#include "emit/emit.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

/* Pixels: points that are as near are one cluster; of a letter and a line of text; between a point and its label. */
enum { NEAR = 12, LETTER = 8, LINE = 17, GAP = 18, POINT = 7, STEP = 3, TRIALS = 16 };

struct box {
	double x0, y0, x1, y1;
};

/* What has a place already. */
struct layout {
	struct plot_label *labels;
	size_t placed;
	const struct plot_point *points;
	size_t count;
	const struct plot_line *lines;
	size_t line_count;
	double width, height;
};

/* ---- clusters ---- */

static int are_near(const struct plot_point *a, const struct plot_point *b)
{
	return a->row->backend == b->row->backend && a->row->precision == b->row->precision &&
		hypot(a->x - b->x, a->y - b->y) <= NEAR;
}

/* Each point's cluster is the first point of it. */
static void cluster_points(struct plot_point *points, size_t count)
{
	for (size_t i = 0; i < count; i++) {
		points[i].cluster = i;
		for (size_t k = 0; k < i; k++) {
			size_t a = points[i].cluster, b = points[k].cluster;

			for (size_t m = 0; are_near(&points[i], &points[k]) && m <= i; m++)
				if (points[m].cluster == a || points[m].cluster == b)
					points[m].cluster = a < b ? a : b;
		}
	}
}

static void put(char *text, size_t size, const char *more, const char *name)
{
	size_t used = strlen(text);

	snprintf(text + used, size - used, "%s%s", more, name);
}

static void put_trigs(unsigned trigs, char *text, size_t size)
{
	const char *more = " ";

	for (int t = 0; t < STUDY_TRIGS; t++)
		if (trigs >> t & 1) {
			put(text, size, more, emit_trig_name((enum rneagen_trig)t));
			more = ", ";
		}
}

/* "f32 accurate, bounded soa"; `trigs` by layout. */
static void name_cluster(const struct study_row *row, const unsigned trigs[STUDY_LAYOUTS], char *text, size_t size)
{
	snprintf(text, size, "%s", emit_precision_name(row->precision));
	if (trigs[RNEAGEN_SOA] == trigs[RNEAGEN_AOS]) {
		put_trigs(trigs[RNEAGEN_SOA], text, size);
		put(text, size, " ", "soa, aos");
		return;
	}
	for (int l = RNEAGEN_SOA; l <= RNEAGEN_AOS; l++) {
		put(text, size, "", l == RNEAGEN_AOS && trigs[RNEAGEN_SOA] && trigs[l] ? ";" : "");
		put_trigs(trigs[l], text, size);
		put(text, size, trigs[l] ? " " : "", trigs[l] ? emit_layout_name((enum rneagen_layout)l) : "");
	}
}

/* The label of cluster i, at the middle of its points. */
static struct plot_label label_of(const struct plot_point *points, size_t count, size_t i)
{
	struct plot_label label = {.text = ""};
	unsigned trigs[STUDY_LAYOUTS] = {0};
	int n = 0;

	for (size_t k = i; k < count; k++)
		if (points[k].cluster == i) {
			trigs[points[k].row->layout] |= 1u << points[k].row->trig | points[k].row->same;
			label.x += points[k].x;
			label.y += points[k].y;
			n++;
		}
	label.x /= n;
	label.y /= n;
	name_cluster(points[i].row, trigs, label.text, sizeof label.text);
	return label;
}

/* ---- places ---- */

static struct box box_of(const struct plot_label *l)
{
	double width = (double)(LETTER * strlen(l->text)), x0 = l->ends_there ? l->at_x - width : l->at_x;

	return (struct box){x0, l->at_y - LINE / 2.0, x0 + width, l->at_y + LINE / 2.0};
}

static int overlap(struct box a, struct box b)
{
	return a.x0 < b.x1 && b.x0 < a.x1 && a.y0 < b.y1 && b.y0 < a.y1;
}

/* Does a line go through a box? It is looked at in steps. */
static int crosses(struct box b, struct plot_line l)
{
	int steps = (int)(hypot(l.x[1] - l.x[0], l.y[1] - l.y[0]) / STEP) + 1;

	for (int i = 0; i <= steps; i++) {
		double t = (double)i / steps, x = l.x[0] + t * (l.x[1] - l.x[0]), y = l.y[0] + t * (l.y[1] - l.y[0]);

		if (x > b.x0 && x < b.x1 && y > b.y0 && y < b.y1)
			return 1;
	}
	return 0;
}

static struct plot_line leader_of(const struct plot_label *l)
{
	return (struct plot_line){{l->x, l->at_x}, {l->y, l->at_y}};
}

static struct box box_of_point(const struct plot_point *p)
{
	return (struct box){p->x - POINT, p->y - POINT, p->x + POINT, p->y + POINT};
}

/* Of label number a->placed, whose points are cluster i. */
static int is_clear(const struct layout *a, const struct plot_label *l, size_t i)
{
	struct box b = box_of(l);
	struct plot_line leader = leader_of(l);

	if (b.x0 < 0 || b.y0 < 0 || b.x1 > a->width || b.y1 > a->height)
		return 0;
	for (size_t k = 0; k < a->count; k++) {
		struct box p = box_of_point(&a->points[k]);

		if (overlap(b, p) || (a->points[k].cluster != i && crosses(p, leader)))
			return 0;
	}
	for (size_t k = 0; k < a->line_count; k++)
		if (crosses(b, a->lines[k]))
			return 0;
	for (size_t k = 0; k < a->placed; k++)
		if (overlap(b, box_of(&a->labels[k])) || crosses(b, leader_of(&a->labels[k])) ||
			crosses(box_of(&a->labels[k]), leader))
			return 0;
	return 1;
}

/* Beside its points, on the side where the frame has more room, above or below, further and further away. */
static int place(const struct layout *a, struct plot_label *l, size_t cluster)
{
	for (int i = 0; i < TRIALS * TRIALS; i++)
		for (int side = 0; side < 2; side++) {
			int away = i / TRIALS, step = (i % TRIALS + 1) / 2 * (i % 2 ? 1 : -1);

			l->ends_there = (l->x > a->width / 2) != side;
			l->at_x = l->x + (l->ends_there ? -GAP : GAP) * (1 + away);
			l->at_y = l->y + step * LINE;
			if (is_clear(a, l, cluster))
				return 1;
		}
	l->at_y = l->y;
	return 0;
}

int plot_place(struct plot_label *labels, size_t *label_count, struct plot_point *points, size_t count,
	const struct plot_line *lines, size_t line_count, double width, double height)
{
	struct layout a = {labels, 0, points, count, lines, line_count, width, height};
	int clear = 1;

	cluster_points(points, count);
	for (size_t i = 0; i < count; i++)
		if (points[i].cluster == i) {
			labels[a.placed] = label_of(points, count, i);
			clear &= place(&a, &labels[a.placed], i);
			a.placed++;
		}
	*label_count = a.placed;
	return clear;
}
