#include "study/plot.h"
#include "emit/emit.h"
#include "rnearun/gnuplot.h"
#include "study/plot_labels.h"
#include <math.h>
#include <stdlib.h>

/* Pixels, of the picture and of what lies around the frame. */
enum { WIDTH = 1000, HEIGHT = 650, HEIGHT_MOST = 1250, LEFT = 80, RIGHT = 190, TOP = 60, BOTTOM = 75, KEY = 48, LETTERS = 14 };

/* Errors below are as good as none. */
#define LEAST_ERROR 1e-17

static const char *const COLOURS[] = {"#1f5fbf", "#d9601a"}; /* of the backends, in their order */

struct axis {
	double from, to; /* logarithms to base 10 */
	double pixels;
};

/* Samples a second that memory allows. */
struct limit {
	size_t backend; /* of study->backends */
	int f32;
	double speed;
	double label_y; /* pixels */
};

enum { LIMITS = 2 * STUDY_WORDS };

struct plot {
	const struct report *report;
	struct plot_point *points;
	size_t count, batch;
	struct limit limits[LIMITS];
	size_t limit_count;
	struct axis x, y; /* of the error, of samples a second */
	struct plot_label *labels;
	size_t label_count;
	struct plot_line *lines; /* that labels keep off: the fronts, the limits, the arrow */
	size_t line_count;
	int height, bottom;
};

/* ---- points ---- */

static double speed_of(const struct study_row *row)
{
	return 1e9 / row->ns;
}

static double error_of(const struct study_row *row)
{
	return fmax(row->errors.max, LEAST_ERROR);
}

static double pixel(const struct axis *a, double value)
{
	return (log10(value) - a->from) / (a->to - a->from) * a->pixels;
}

/* By backend; the fastest first, of those the closest. */
static int by_speed(const void *a, const void *b)
{
	const struct study_row *p = ((const struct plot_point *)a)->row, *q = ((const struct plot_point *)b)->row;

	if (p->backend != q->backend)
		return (p->backend > q->backend) - (p->backend < q->backend);
	if (p->ns != q->ns)
		return (p->ns > q->ns) - (p->ns < q->ns);
	return (p->errors.max > q->errors.max) - (p->errors.max < q->errors.max);
}

static int take_points(struct plot *p)
{
	const struct report *r = p->report;

	p->points = calloc(r->count + 1, sizeof *p->points);
	p->labels = calloc(r->count + 1, sizeof *p->labels);
	p->lines = calloc(r->count + LIMITS + 1, sizeof *p->lines);
	if (!p->points || !p->labels || !p->lines)
		return 0;
	for (size_t i = 0; i < r->count; i++)
		p->batch = r->rows[i].batch > p->batch ? r->rows[i].batch : p->batch;
	for (size_t i = 0; i < r->count; i++)
		if (r->rows[i].batch == p->batch && isfinite(r->rows[i].errors.max))
			p->points[p->count++].row = &r->rows[i];
	qsort(p->points, p->count, sizeof *p->points, by_speed);
	return 1;
}

/* Is it on the front: is nothing of its backend as fast and as close, and better in one? */
static int is_unbeaten(const struct plot *p, const struct study_row *a)
{
	for (size_t i = 0; i < p->count; i++) {
		const struct study_row *b = p->points[i].row;

		if (b->backend == a->backend && error_of(b) <= error_of(a) && b->ns <= a->ns &&
			(error_of(b) < error_of(a) || b->ns < a->ns))
			return 0;
	}
	return 1;
}

/* ---- limits of memory ---- */

/* The most that was measured beside the variants of a type: what else the machine does only takes away. */
static void take_limit(struct plot *p, size_t backend, int f32)
{
	double most = 0;

	for (size_t i = 0; i < p->count; i++) {
		const struct study_row *r = p->points[i].row;

		if (r->backend == p->report->study->backends[backend].backend && judge_is_f32(r->precision) == f32)
			most = fmax(most, speed_of(r) / r->floor_ratio);
	}
	if (most > 0)
		p->limits[p->limit_count++] = (struct limit){.backend = backend, .f32 = f32, .speed = most};
}

/* ---- the frame ---- */

static void widen(struct axis *a, double value, double below, double above)
{
	a->from = fmin(a->from, log10(value) - below);
	a->to = fmax(a->to, log10(value) + above);
}

static void set_ranges(struct plot *p)
{
	p->x = (struct axis){(double)INFINITY, -(double)INFINITY, WIDTH - LEFT - RIGHT};
	p->y = (struct axis){(double)INFINITY, -(double)INFINITY, p->height - TOP - p->bottom};
	for (size_t i = 0; i < p->count; i++) {
		widen(&p->x, error_of(p->points[i].row), 1.5, 1.5);
		widen(&p->y, speed_of(p->points[i].row), 0.2, 0.3);
	}
	for (size_t i = 0; i < p->limit_count; i++)
		widen(&p->y, p->limits[i].speed, 0.1, 0.3);
	for (size_t i = 0; i < p->count; i++) {
		p->points[i].x = pixel(&p->x, error_of(p->points[i].row));
		p->points[i].y = pixel(&p->y, speed_of(p->points[i].row));
	}
}

static void add_line(struct plot *p, double x0, double y0, double x1, double y1)
{
	p->lines[p->line_count++] = (struct plot_line){{x0, x1}, {y0, y1}};
}

/* The fronts, the limits, and "better" with its arrow. */
static void take_lines(struct plot *p)
{
	const struct plot_point *last = NULL;

	p->line_count = 0;
	for (size_t i = 0; i < p->count; i++) {
		const struct plot_point *q = &p->points[i];

		if (!is_unbeaten(p, q->row))
			continue;
		if (last && last->row->backend == q->row->backend)
			add_line(p, last->x, last->y, q->x, q->y);
		last = q;
	}
	for (size_t i = 0; i < p->limit_count; i++)
		add_line(p, 0, pixel(&p->y, p->limits[i].speed), p->x.pixels, pixel(&p->y, p->limits[i].speed));
	add_line(p, 0, p->y.pixels - 20, 120, p->y.pixels - 20);
}

/* The limits' labels stand right of the frame, apart from each other. */
static void place_limits(struct plot *p)
{
	for (size_t i = 0; i < p->limit_count; i++) {
		struct limit *l = &p->limits[i];

		l->label_y = pixel(&p->y, l->speed);
		for (size_t k = 0; k < i; k++)
			if (fabs(l->label_y - p->limits[k].label_y) < LETTERS) {
				l->label_y = p->limits[k].label_y + LETTERS;
				k = (size_t)-1;
			}
	}
}

/* The picture is as high as its labels need. */
static void arrange(struct plot *p)
{
	p->bottom = BOTTOM + KEY * p->report->study->backend_count;
	for (p->height = HEIGHT;; p->height += 100) {
		set_ranges(p);
		take_lines(p);
		if (plot_place(p->labels, &p->label_count, p->points, p->count, p->lines, p->line_count,
			p->x.pixels, p->y.pixels) ||
			p->height >= HEIGHT_MOST)
			break;
	}
	place_limits(p);
}

/* ---- the script ---- */

static void put_label(const struct plot *p, const struct plot_label *l, FILE *f)
{
	double side = l->ends_there ? 3 : -3;

	fprintf(f, "set label '%s' at graph %.6f,%.6f %s noenhanced front\n", l->text, l->at_x / p->x.pixels,
		l->at_y / p->y.pixels, l->ends_there ? "right" : "left");
	fprintf(f, "set arrow from graph %.6f,%.6f to graph %.6f,%.6f nohead back lc rgb '#808080' lw 0.5\n", l->x / p->x.pixels,
		l->y / p->y.pixels, (l->at_x + side) / p->x.pixels, l->at_y / p->y.pixels);
}

static void put_limit(const struct plot *p, const struct limit *l, FILE *f)
{
	const struct study *s = p->report->study;
	const char *colour = COLOURS[l->backend % 2];
	double y = pixel(&p->y, l->speed) / p->y.pixels;

	fprintf(f, "set arrow from graph 0,%.6f to graph 1,%.6f nohead back dashtype 2 lc rgb '%s'\n", y, y, colour);
	fprintf(f, "set label '%s: limit of memory,", study_backend_name(s->backends[l->backend].backend));
	fprintf(f, " %s' at graph 1.008,%.6f left font ',10' textcolor rgb '%s'\n", l->f32 ? "floats" : "doubles",
		l->label_y / p->y.pixels, colour);
}

/* All points of a backend, and those of its front. */
static void put_data(const struct plot *p, enum rnea_backend backend, FILE *f)
{
	for (int front = 0; front < 2; front++) {
		fprintf(f, "$%s_%s << EOD\n", study_backend_name(backend), front ? "front" : "all");
		for (size_t i = 0; i < p->count; i++) {
			const struct study_row *r = p->points[i].row;

			if (r->backend == backend && (!front || is_unbeaten(p, r)))
				fprintf(f, "%.9g %.9g\n", error_of(r), speed_of(r));
		}
		fprintf(f, "EOD\n");
	}
}

static void put_frame(const struct plot *p, FILE *f)
{
	fprintf(f, "set terminal svg size %d,%d font 'sans-serif,13' background rgb 'white'\n", WIDTH, p->height);
	fprintf(f, "set lmargin at screen %.6f\nset rmargin at screen %.6f\n", (double)LEFT / WIDTH, 1 - (double)RIGHT / WIDTH);
	fprintf(f, "set tmargin at screen %.6f\nset bmargin at screen %.6f\n", 1 - (double)TOP / p->height,
		(double)p->bottom / p->height);
	fprintf(f, "set title '");
	gnuplot_put_name(f, p->report->study->analysis.robot.name);
	fprintf(f, ": inverse dynamics, speed against error' noenhanced font ',17'\n");
	fprintf(f, "set logscale xy\nset format x '1e%%T'\nset format y '%%.0te%%T'\nset grid lc rgb '#e0e0e0'\n");
	fprintf(f, "set key below maxcolumns 1 spacing 1.2 noenhanced\n");
	fprintf(f, "set xlabel 'largest error of %zu samples, |tau - ref| / |ref|'\n", p->report->study->options->sample.count);
	fprintf(f, "set ylabel 'samples per second, in batches of %zu'\n", p->batch);
	fprintf(f, "set xrange [%.9g:%.9g]\nset yrange [%.9g:%.9g]\n", pow(10, p->x.from), pow(10, p->x.to), pow(10, p->y.from),
		pow(10, p->y.to));
	fprintf(f, "set label 'better' at graph %.6f,%.6f font ',15' textcolor rgb '#2a7a2a'\n"
		   "set arrow from graph %.6f,%.6f to graph %.6f,%.6f lw 2 lc rgb '#2a7a2a'\n", 52 / p->x.pixels,
		1 - 22 / p->y.pixels, 48 / p->x.pixels, 1 - 34 / p->y.pixels, 12 / p->x.pixels, 1 - 10 / p->y.pixels);
}

/* 1, 2 and 5 of each decade, where there are few decades. */
static void put_tics(const struct axis *y, FILE *f)
{
	static const int steps[] = {1, 2, 5};
	const char *comma = "";

	if (y->to - y->from > 2.5)
		return;
	fprintf(f, "set ytics (");
	for (int d = (int)floor(y->from); d <= (int)y->to; d++)
		for (int i = 0; i < 3; i++) {
			fprintf(f, "%s%de%d", comma, steps[i], d);
			comma = ", ";
		}
	fprintf(f, ")\n");
}

static void put_curves(const struct plot *p, FILE *f)
{
	const struct study *s = p->report->study;

	fprintf(f, "plot");
	for (int i = 0; i < s->backend_count; i++) {
		const char *name = study_backend_name(s->backends[i].backend), *colour = COLOURS[i % 2];

		fprintf(f, "%s $%s_all using 1:2 with points pt 6 ps 0.7 lc rgb '%s' title '%s, ", i ? "," : "",
			name, colour, name);
		gnuplot_put_name(f, s->backends[i].device);
		fprintf(f, "', $%s_front using 1:2 smooth unique with linespoints pt 7 ps 1.1 lw 2 lc rgb '%s' title '%s: nothing "
			   "is both faster and closer'", name, colour, name);
	}
	fputc('\n', f);
}

static void put_script(const void *plot, FILE *f)
{
	const struct plot *p = plot;

	for (int i = 0; i < p->report->study->backend_count; i++)
		put_data(p, p->report->study->backends[i].backend, f);
	put_frame(p, f);
	put_tics(&p->y, f);
	for (size_t i = 0; i < p->limit_count; i++)
		put_limit(p, &p->limits[i], f);
	for (size_t i = 0; i < p->label_count; i++)
		put_label(p, &p->labels[i], f);
	put_curves(p, f);
}

enum rneagen_code plot_write(const struct report *r, const char *path, struct rneagen_error *e)
{
	struct plot p = {.report = r};

	if (!take_points(&p))
		error_memory(e);
	else if (!p.count)
		error_set(e, RNEAGEN_UNSUPPORTED, "--plot: no variant has a finite error");
	if (!e->code) {
		for (size_t i = 0; i < 2 * (size_t)r->study->backend_count; i++)
			take_limit(&p, i / 2, i % 2);
		arrange(&p);
		gnuplot_draw("--plot", path, put_script, &p, e);
	}
	free(p.points);
	free(p.labels);
	free(p.lines);
	return e->code;
}
