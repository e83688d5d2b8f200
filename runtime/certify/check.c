#include "certify/check.h"
#include "certify/assumptions.h"
#include "certify/check_row.h"
#include "certify/left_out.h"
#include "emit/emit.h"
#include <stdlib.h>
#include <string.h>

static const char *const TOP[] = {"format", "version", "robot", "asked", "texts", "assumptions", "ranges", "rows", NULL};
static const char *const ROBOT[] = {"name", "file", "sha256", NULL};
static const char *const ASKED[] = {"trig", "base", "mimic", "strict", "gravity", "order", "scene", NULL};
static const char *const TEXT[] = {"target", "precision", "sha256", NULL};
static const char *const RANGE[] = {"input", "row", "lower", "upper", NULL};

struct checking {
	const struct check_input *in;
	struct reader r;
	struct rneagen_error *e;
	json_t *root;
	struct file_content urdf;
	struct rneagen_options options;
	struct analysis analysis;
	struct certificate c;
	enum rneagen_precision precisions[STEPS_PRECISIONS];
	struct arena arena;
};

static enum rneagen_code refuse(struct checking *x, const char *what)
{
	return error_set(x->e, RNEAGEN_READ, "%s: %s", x->in->file, what);
}

/* ---- what was asked ---- */

static enum rneagen_code check_version(struct checking *x)
{
	const char *version = read_word(&x->r, x->root, "the certificate", "version");

	if (!x->e->code && read_whole(&x->r, json_object_get(x->root, "format"), "\"format\"", 0, 1 << 30) !=
		CERTIFICATE_FORMAT && !x->e->code)
		return refuse(x, "its \"format\" is not known; this program knows format 1");
	if (!x->e->code && strcmp(version, RNEAGEN_VERSION) != 0)
		return error_set(x->e, RNEAGEN_READ,
			"%s: it is of version \"%.40s\", this program of " RNEAGEN_VERSION ", whose texts may differ",
			x->in->file, version);
	return x->e->code;
}

static enum rneagen_code check_robot(struct checking *x)
{
	const json_t *robot = json_object_get(x->root, "robot");
	const char *file, *stated;
	char hash[HASH_TEXT];

	if (read_keys(&x->r, robot, "\"robot\"", ROBOT))
		return x->e->code;
	file = read_word(&x->r, robot, "\"robot\"", "file");
	stated = read_word(&x->r, robot, "\"robot\"", "sha256");
	x->options.file = file;
	if (x->e->code || file_read(x->in->urdf ? x->in->urdf : file, &x->urdf, x->e))
		return x->e->code;
	asked_hash(x->urdf.bytes, x->urdf.length, hash);
	if (strcmp(hash, stated) != 0)
		return error_set(x->e, RNEAGEN_READ, "%s: is not about %s: that URDF's hash is %s, not %.80s", x->in->file,
			x->in->urdf ? x->in->urdf : file, hash, stated);
	return RNEAGEN_OK;
}

/* Which of the words it is; an error where it is none. */
static int word_of(struct checking *x, const json_t *object, const char *key, const char *const *words)
{
	const char *word = read_word(&x->r, object, "\"asked\"", key);

	for (int i = 0; words[i]; i++)
		if (!strcmp(word, words[i]))
			return i;
	error_set(x->e, RNEAGEN_READ, "%s: \"%s\" is \"%.40s\", which is not known", x->in->file, key, word);
	return 0;
}

static enum rneagen_code read_asked(struct checking *x)
{
	static const char *const trigs[] = {"accurate", "bounded", "fast", NULL}, *const bases[] = {"fixed", "floating", NULL};
	static const char *const mimics[] = {"honour", "independent", NULL};
	const json_t *asked = json_object_get(x->root, "asked"), *gravity, *order;

	if (read_keys(&x->r, asked, "\"asked\"", ASKED))
		return x->e->code;
	x->options.trig = (enum rneagen_trig)word_of(x, asked, "trig", trigs);
	x->options.base = (enum rneagen_base)word_of(x, asked, "base", bases);
	x->options.mimic = (enum rneagen_mimic)word_of(x, asked, "mimic", mimics);
	x->options.strict = json_is_true(json_object_get(asked, "strict"));
	if (!json_is_boolean(json_object_get(asked, "strict")))
		return refuse(x, "\"strict\" is neither true nor false");
	gravity = read_member(&x->r, asked, "\"asked\"", "gravity", JSON_ARRAY);
	if (gravity && json_array_size(gravity) != 3)
		return refuse(x, "\"gravity\" is not of three numbers");
	for (size_t i = 0; i < 3 && gravity; i++)
		x->options.gravity[i] = read_number(&x->r, json_array_get(gravity, i), "\"gravity\"", (double)NAN);
	order = json_object_get(asked, "order");
	x->options.order = json_is_null(order) ? NULL : read_word(&x->r, asked, "\"asked\"", "order");
	x->options.scene = read_word(&x->r, asked, "\"asked\"", "scene");
	return x->e->code;
}

static enum rneagen_code analyse(struct checking *x)
{
	if (!(x->options.gravity[0] + x->options.gravity[1] + x->options.gravity[2] < (double)INFINITY))
		return refuse(x, "\"gravity\" is not of three numbers");
	x->options.layout = RNEAGEN_AOS;
	if (analysis_open(&x->analysis, x->urdf.bytes, x->urdf.length, &x->options, x->e))
		return x->e->code;
	x->c.a = &x->analysis;
	if (adjust_is_asked(&x->analysis.adjust))
		return refuse(x, "its scene changes constants, so no bound is of the robot as its file states it");
	return RNEAGEN_OK;
}

/* ---- the text ---- */

static int precision_of(const char *word)
{
	static const enum rneagen_precision all[] = {RNEAGEN_F32, RNEAGEN_F64, RNEAGEN_MIXED, RNEAGEN_F32X2};

	for (size_t i = 0; i < sizeof all / sizeof *all; i++)
		if (!strcmp(word, emit_precision_name(all[i])))
			return (int)all[i];
	return -1;
}

static enum rneagen_code check_text(struct checking *x, const json_t *text)
{
	const char *word, *stated;
	char hash[HASH_TEXT];
	int precision;

	if (read_keys(&x->r, text, "a text", TEXT))
		return x->e->code;
	word = read_word(&x->r, text, "a text", "precision");
	stated = read_word(&x->r, text, "a text", "sha256");
	precision = precision_of(word);
	for (int k = 0; k < x->c.precision_count; k++)
		precision = (int)x->precisions[k] == precision ? -1 : precision;
	if (x->e->code || precision < 0 || strcmp(read_word(&x->r, text, "a text", "target"), "c") != 0)
		return refuse(x, "a text is not of target c, or of a precision that is not known or there twice");
	if (asked_text_hash(&x->analysis, (enum rneagen_precision)precision, hash, x->e))
		return x->e->code;
	if (strcmp(hash, stated) != 0)
		return error_set(x->e, RNEAGEN_READ,
			"%s: is not about the text in %s that this program makes: its hash is %s, not %.80s", x->in->file,
			word, hash, stated);
	x->precisions[x->c.precision_count++] = (enum rneagen_precision)precision;
	return RNEAGEN_OK;
}

static enum rneagen_code check_texts(struct checking *x)
{
	const json_t *texts = read_member(&x->r, x->root, "the certificate", "texts", JSON_ARRAY);

	if (texts && (json_array_size(texts) == 0 || json_array_size(texts) > STEPS_PRECISIONS))
		return refuse(x, "\"texts\" is not of one to four texts");
	for (size_t i = 0; i < json_array_size(texts) && !x->e->code; i++)
		check_text(x, json_array_get(texts, i));
	return x->e->code;
}

static enum rneagen_code check_assumptions(struct checking *x)
{
	const json_t *list = read_member(&x->r, x->root, "the certificate", "assumptions", JSON_ARRAY);

	size_t count = 0;
	int is_same = 1;

	for (int i = 0; list && i < ASSUMPTION_COUNT; i++)
		if (assumption_is_needed(&x->analysis, i)) {
			const char *s = json_string_value(json_array_get(list, count++));

			is_same &= s && !strcmp(s, ASSUMPTIONS[i].text);
		}
	if (list && (!is_same || json_array_size(list) != count))
		return refuse(x, "its assumptions are not those that a bound of this version rests on");
	return x->e->code;
}

/* ---- ranges ---- */

static enum rneagen_code check_range(struct checking *x, const json_t *range, const struct asked_box *box, size_t *left)
{
	const struct dag *d = &x->analysis.dag;
	struct span own, stated;
	const char *input;
	int argument, row;

	if (read_keys(&x->r, range, "a range", RANGE))
		return x->e->code;
	input = read_word(&x->r, range, "a range", "input");
	argument = dag_find_argument(d, input);
	if (x->e->code || argument < 0 || !box->rows[argument])
		return error_set(x->e, RNEAGEN_READ, "%s: there is no input \"%.80s\"", x->in->file, input);
	row = read_whole(&x->r, json_object_get(range, "row"), "\"row\" of a range", 0, d->arguments[argument].rows - 1);
	stated = (struct span){read_number(&x->r, json_object_get(range, "lower"), "a range", (double)NAN),
		read_number(&x->r, json_object_get(range, "upper"), "a range", (double)NAN)};
	own = box->rows[argument][row];
	if (x->e->code)
		return x->e->code;
	if (!(own.lo <= own.hi) || !(stated.lo == own.lo && stated.hi == own.hi))
		return error_set(x->e, RNEAGEN_READ,
			"%s: the range of %s[%d] is from %.17g to %.17g by the robot and the scene, or there twice, not "
			"from %.17g to %.17g", x->in->file, input, row, own.lo, own.hi, stated.lo, stated.hi);
	box->rows[argument][row] = (struct span){1, 0};
	(*left)--;
	return RNEAGEN_OK;
}

static enum rneagen_code check_output_known(struct checking *x, size_t output, unsigned char *live)
{
	const struct dag *d = &x->analysis.dag;

	left_out_reads(d, output, live);
	for (size_t i = 0; i < d->count; i++) {
		const struct node *n = &d->nodes[i];
		const struct span *r = live[i] && n->op == OP_INPUT ? &x->c.box.rows[n->arg[0].i][n->arg[1].i] : NULL;

		if (r && !(r->lo <= r->hi))
			return error_set(x->e, RNEAGEN_READ, "%s: no range is known of %s[%d]", x->in->file,
				d->arguments[n->arg[0].i].name, (int)n->arg[1].i);
	}
	return RNEAGEN_OK;
}

/* Every input that is read has one, but for outputs of which nothing is stated. */
static enum rneagen_code check_known(struct checking *x)
{
	unsigned char *live = arena_alloc(&x->arena, x->analysis.dag.count, 1);

	for (size_t i = 0; live && i < x->analysis.dag.output_count; i++)
		if (!left_out(&x->analysis, i) && check_output_known(x, i, live))
			return x->e->code;
	return live ? RNEAGEN_OK : error_memory(x->e);
}

/* Each known range is stated once. */
static enum rneagen_code check_ranges(struct checking *x)
{
	const json_t *list = read_member(&x->r, x->root, "the certificate", "ranges", JSON_ARRAY);
	const struct dag *d = &x->analysis.dag;
	struct asked_box left;
	size_t count = 0;

	if (!list || !certificate_ask(&x->c, &x->arena) || !asked_copy(&left, &x->c.box, d, &x->arena))
		return list ? error_memory(x->e) : x->e->code;
	if (check_known(x))
		return x->e->code;
	for (int i = 0; i < d->argument_count; i++)
		for (int r = 0; left.rows[i] && r < d->arguments[i].rows; r++)
			count += left.rows[i][r].lo <= left.rows[i][r].hi;
	for (size_t i = 0; i < json_array_size(list) && !x->e->code; i++)
		check_range(x, json_array_get(list, i), &left, &count);
	return count && !x->e->code ? refuse(x, "a range of an input is missing") : x->e->code;
}

/* ---- all ---- */

static enum rneagen_code check_all(struct checking *x, struct text *report)
{
	x->root = read_json(&x->r, x->in->certificate.bytes, x->in->certificate.length);
	if (!x->root || read_keys(&x->r, x->root, "the certificate", TOP) || check_version(x) || check_robot(x) ||
		read_asked(x) || analyse(x) ||
		check_texts(x) || check_assumptions(x) || check_ranges(x))
		return x->e->code;
	if (check_rows(&x->c, &x->r, read_member(&x->r, x->root, "the certificate", "rows", JSON_ARRAY), x->in->threads, report))
		return x->e->code;
	text_put(report, "\nThis holds if:\n");
	for (int i = 0; i < ASSUMPTION_COUNT; i++)
		if (assumption_is_needed(&x->analysis, i))
			text_printf(report, "- %s\n", ASSUMPTIONS[i].text);
	return RNEAGEN_OK;
}

enum rneagen_code certificate_check(const struct check_input *in, struct text *report, struct rneagen_error *e)
{
	struct checking x = {.in = in, .r = {in->file, e}, .e = e, .options = rneagen_options_default()};

	x.c.precisions = x.precisions;
	arena_init(&x.arena, NULL);
	check_all(&x, report);
	if (x.c.a)
		analysis_free(&x.analysis);
	json_decref(x.root);
	arena_free(&x.arena);
	free(x.urdf.bytes);
	return e->code;
}
