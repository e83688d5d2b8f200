/* The comment at which a part of the algorithm begins, and below it, where it is the first of its kind, the formula. */
#include "emit/unparse.h"

/* As joint types have them in common. */
enum kind_of_joint { TURNS, SLIDES, HOLDS, FLOATS, PLANE, JOINT_KINDS };
_Static_assert((int)JOINT_KINDS == (int)SECTION_JOINT_KINDS, "a row for each kind of joint");

static enum kind_of_joint kind_of(const struct body *k)
{
	switch (k->type) {
	case JOINT_PRISMATIC:
		return SLIDES;
	case JOINT_FIXED:
		return HOLDS;
	case JOINT_FLOATING:
		return FLOATS;
	case JOINT_PLANAR:
		return PLANE;
	default:
		return TURNS;
	}
}

/* dynamics/rnea.c, move. V is how fast the joint slides, dV its rate. */
static const char *const OUT[JOINT_KINDS] = {
	[TURNS] = "w = R'w_p + z qd;  dw = R'dw_p + z qdd + R'w_p x z qd;  a = R'(a_p + U_p p)",
	[SLIDES] = "w = R'w_p;  dw = R'dw_p;  a = R'(a_p + U_p p) + z qdd + 2 w x z qd",
	[HOLDS] = "w = R'w_p;  dw = R'dw_p;  a = R'(a_p + U_p p)",
	[FLOATS] = "w = R'w_p + qd_w;  dw = R'dw_p + qdd_w + R'w_p x qd_w;  a = R'(a_p + U_p p) + dV + 2 R'w_p x V,  V = qd_v,  "
		"dV = qdd_v + qd_w x qd_v",
	[PLANE] = "w = R'w_p + z qd_t;  dw = R'dw_p + z qdd_t + R'w_p x z qd_t;  a = R'(a_p + U_p p + dV + 2 w_p x V),  V = qd_xy,  "
		"dV = qdd_xy in the joint's plane"};

static const char *const VELOCITY[JOINT_KINDS] = {[TURNS] = "v = R'(v_p + w_p x p)", [SLIDES] = "v = R'(v_p + w_p x p) + z qd",
	[HOLDS] = "v = R'(v_p + w_p x p)", [FLOATS] = "v = R'(v_p + w_p x p) + V", [PLANE] = "v = R'(v_p + w_p x p + V)"};

/* The same file, leave; at_rest_leave. */
static const char BACK[] = "f_p += R f;  n_p += R n + p x R f",
	REST_BACK[] = "f = M a;  n = mc x a;  M_p += M;  mc_p += R mc + M p";

static const char *const TORQUE[JOINT_KINDS] = {[TURNS] = ";  tau = z.n", [SLIDES] = ";  tau = z.f", [HOLDS] = "",
	[FLOATS] = ";  tau = (f, n)", [PLANE] = ";  tau = (f_x, f_y, n_z)"};

static const char *const OTHERS[SECTION_COUNT] = {[SECTION_END] = "tau of a driver += multiplier tau of each follower",
	[SECTION_TOTALS] = "power = qd.tau;  kinetic = sum of (v.(m v + 2 w x h) + w.I w)/2",
	[SECTION_BIAS] = "bias = ID(q, qd, 0)",
	[SECTION_GRAVITY] = "gravity = ID(q, 0, 0);  potential = -g.mc of all that moves",
	[SECTION_BY] = "column j, or row j, of d tau/d q, d tau/d qd and M = d tau/d qdd, for the rows j of the joint",
	[SECTION_FACTORS] =
		"qdd_0 above: z.dw = 0 of joints that turn;  M = L'D L;  L'y = tau - ID(q, qd, qdd_0);  L (qdd - qdd_0) = y/D",
	[SECTION_ARTICULATED] =
		"U = I S, D = S'U, I_p += R (I - U U'/D) R' on the way back above;  now back:\n\t   "
		"u = tau - ID(q, qd, qdd_0) - S'p, p_p += R (p + U u/D);  and out: d = (u - U'a)/D, a = R'a_p + S d;  qdd = qdd_0 + d,\n\t   "
		"with qdd_0 above: z.dw = 0 of joints that turn",
	[SECTION_INVERSE] = "L Minv = D^-1 L'^-1, or as qdd - qdd_0 from the columns of 1 for tau - ID",
	[SECTION_BOUND] =
		"with X near M^-1, d and e how far r and M may be off by rounding, and E >= |I - X M|:\n\t   "
		"y = |X| (|r| + d);  E y = |I - X M| y + |X| (e + rounding) y;  k = the largest E y/y;  |qdd - exact| <= y/(1 - k)",
	[SECTION_RESIDUAL] =
		"r = tau - ID(q, qd, qdd) at the qdd found, from inputs and constants in more bits where the head says so",
	[SECTION_REFINED] = "M d = r;  qdd += d",
	[SECTION_REGRESSOR] =
		"W, V of the body by a unit rate of each joint on the way here: W = R'W_p, V = R'(V_p + W_p x p);\n\t   "
		"their power V.f + W.n by a unit of m: V.a;  of h: U'V + a x W;  of I: W.(I dw + w x I w)",
	[SECTION_COLUMNS] = "L'y = -d ID;  L d qdd = y/D",
	[SECTION_WAY] =
		"of each coordinate beyond: sn += p x sf, sm += p' x sf;  nq += p x fq, nd += p x fd;  it feels the\n\t   "
		"joint's q and qd, which change accelerations by alpha x r + beta x r' + gamma, by sn.alpha + sm.beta + sf.gamma;\n\t   "
		"the joint feels z.nq and z.nd, or z.fq and z.fd",
	[SECTION_ROWS] = "in an order in which few values wait: what the rows of the joint take, and what is complete then",
	[SECTION_INPUTS] = "in an order in which few values wait: what the inputs of the joints so far are enough for",
	[SECTION_SWEEPS] = "of the outputs y by the state x and other inputs, dqdd = M^-1 (dtau - dID) where qdd is found:\n\t   "
			   "jvp = dy/dx jvp_v, forwards;  vjp = vjp_v' dy/dx, backwards",
	[SECTION_PLACE] = "R = R_p X R(q);  p = p_p + R_p x",
	[SECTION_JACOBIAN] =
		"column of a joint: w = z, v = w x r, of one that slides v = z; r from its origin to the point that is told of",
	[SECTION_SUBTREE] =
		"mc_p += D = R mc + m p;  P_p += R P + m p';  K_p += R K + p x R P + D x p';  F_p += R F + m p'';\n\t   "
		"N_p += R N + p x R F + D x p'';  a column of the matrix, of the unit twist (Z, Y): Z x mc + m Y, I Z + mc x Y",
	[SECTION_CENTROID] = "com = mc/m;  momentum: P, and K - com x P about the centre of mass;  rates: F, and N - com x F",
	[SECTION_OPSPACE] =
		"inverse = J Minv J' = Y' D^-1 Y;  by factors: M = L'D L, L'Y = J';  by articulated bodies: Y = what\n\t   "
		"joints feel of unit wrenches on the link",
	[SECTION_CONTACTS] =
		"J accelerates what stands, to nothing: M qdd - J' f = tau - bias, J qdd + dJ/dt qd = 0;  M = L'D L, L'Y = J',\n\t   "
		"S = Y' D^-1 Y;  L'y = tau - ID;  f = -S^-1 (Y' D^-1 y + a);  L d = D^-1 (y + Y f);  qdd = qdd_0 + d",
	[SECTION_RATE] = "dJ/dt qd = the acceleration that is left where qdd = 0",
	[SECTION_PRODUCTS] = "jvp = d tau/d q v_q + d tau/d qd v_qd + M v_qdd;  vjp = v' d tau/d q, v' d tau/d qd, v' M"};

/* A tour of gravity alone comes last. */
static int is_at_rest(const struct dag *d, const struct section *s)
{
	for (const struct section *x = d->sections; x <= s; x++)
		if (x->kind == SECTION_GRAVITY)
			return 1;
	return 0;
}

static void put_out(const struct function *p, enum kind_of_joint joint, int rests, struct text *out)
{
	if (dag_find_role(&p->dag, ROLE_BODY_WRENCHES, 0) >= 0) {
		text_put(out, "f, n = what fpass wrote, in the link's frame here");
		return;
	}
	if (rests) {
		text_put(out, "a = R'a_p");
		return;
	}
	text_put(out, OUT[joint]);
	if (dag_find_role(&p->dag, ROLE_BODY_TWISTS, 1) >= 0 || emit_names(&p->plan, "v"))
		text_printf(out, ";  %s", VELOCITY[joint]);
	text_put(out, ";\n\t   f = m a + U h;  n = I dw + w x I w + h x a");
}

/* Once for each way in which it is written. */
static void put_formula(struct unparser *u, const struct section *s, struct text *out)
{
	int rests = is_at_rest(u->plan->dag, s), about_body = s->kind == SECTION_OUT || s->kind == SECTION_BACK;
	enum kind_of_joint joint = about_body ? kind_of(&u->emission->tree->bodies[s->body]) : TURNS;
	unsigned char *written = &u->written[s->kind][joint];

	if (*written & (1 << rests) || (!about_body && !OTHERS[s->kind]) ||
		(s->kind == SECTION_COLUMNS && dag_loops_go_back(u->plan->dag)))
		return;
	*written |= (unsigned char)(1 << rests);
	text_put(out, "\t/* ");
	if (s->kind == SECTION_OUT)
		put_out(u->function, joint, rests, out);
	else if (s->kind == SECTION_BACK)
		text_printf(out, "%s%s", rests ? REST_BACK : BACK, TORQUE[joint]);
	else
		text_put(out, OTHERS[s->kind]);
	text_put(out, " */\n");
}

/* Of sections that are about no body. */
static const char *const SECTION_TITLES[SECTION_COUNT] = {[SECTION_END] = "torques of joints that others mimic",
	[SECTION_FREED] = "what the scene frees", [SECTION_TOTALS] = "power and energies",
	[SECTION_BIAS] = "from here on without accelerations: torques of gravity and velocities",
	[SECTION_GRAVITY] = "from here on at rest: torques of gravity",
	[SECTION_FACTORS] = "qdd, by factors of the mass matrix", [SECTION_ARTICULATED] = "qdd, by articulated bodies",
	[SECTION_INVERSE] = "inverse of the mass matrix",
	[SECTION_BOUND] = "how far qdd may be off",
	[SECTION_RESIDUAL] = "from here on once more: the residual of the qdd found",
	[SECTION_REFINED] = "qdd, refined",
	[SECTION_SWEEPS] = "derivatives of outputs times vectors",
	[SECTION_COLUMNS] = "a column of the derivatives of qdd, from -d ID, by the factors of the mass matrix",
	[SECTION_RATE] = "from here on without accelerations and gravity",
	[SECTION_CENTROID] = "centre of mass and momentum",
	[SECTION_FACTORED] = "factors of the mass matrix",
	[SECTION_CONTACTS] = "forces on what stands, and qdd with them",
	[SECTION_PRODUCTS] = "derivatives times vectors, and by what is freed"};

/* Of others, what is before the name of a joint, or before the number and the name of a link. */
static const char *const ABOUT[SECTION_COUNT] = {[SECTION_BY] = "derivatives by", [SECTION_ROWS] = "rows of",
	[SECTION_INPUTS] = "with the inputs up to",
	[SECTION_REGRESSOR] = "torques by the inertial parameters of link"};
static const char *const ABOUT_LINKS[SECTION_COUNT] = {[SECTION_OUT] = "out to", [SECTION_BACK] = "back from",
	[SECTION_PLACE] = "place of", [SECTION_WAY] = "coordinates go back from",
	[SECTION_JACOBIAN] = "Jacobian of what is on", [SECTION_SUBTREE] = "back from", [SECTION_OPSPACE] = "inertia felt on"};

/* Columns behind coordinates that go back in loops are solved without factors. */
static const char *title_of(const struct function *function, const struct section *s)
{
	return s->kind == SECTION_COLUMNS && dag_loops_go_back(&function->dag)
		? "a column of the derivatives of qdd, from -d ID, by articulated bodies" : SECTION_TITLES[s->kind];
}

static void put_quoted(const char *name, struct text *out)
{
	text_putc(out, '"');
	text_put_comment(out, name);
	text_putc(out, '"');
}

/* Where the way back goes, and the torque that is complete then. */
static void put_back(const struct emission *e, const struct body *k, struct text *out)
{
	if (k->parent < 0)
		text_put(out, " to the world (bpass)");
	else
		text_printf(out, " to link %d (bpass)", e->tree->bodies[k->parent].number);
	if (!*k->joint)
		return;
	text_put(out, k->type == JOINT_FIXED ? ": held at " : k->follower ? ": share of the driver of " : ": torque of ");
	put_quoted(k->joint, out);
}

/* "out to link 2 "lower" (fpass)"; "back from link 2 "lower" to link 1 (bpass): torque of "elbow"" */
static void put_title(const struct emission *e, const struct function *function, const struct section *s, struct text *out)
{
	const struct body *k = &e->tree->bodies[s->body];

	text_put(out, "\n\t/* ---- ");
	if (SECTION_TITLES[s->kind]) {
		text_put(out, title_of(function, s));
	} else if (ABOUT[s->kind]) {
		text_printf(out, "%s ", ABOUT[s->kind]);
		put_quoted(s->kind == SECTION_REGRESSOR ? k->link : *k->joint ? k->joint : "base", out);
	} else {
		text_printf(out, "%s link %d ", ABOUT_LINKS[s->kind], k->number);
		put_quoted(k->link, out);
	}
	if (s->kind == SECTION_OUT)
		text_put(out, dag_find_role(&function->dag, ROLE_BODY_WRENCHES, 0) >= 0 ? "" : " (fpass)");
	else if (s->kind == SECTION_BACK)
		put_back(e, k, out);
	text_put(out, " ---- */\n");
}

/* A section that has no lines of its own, but for those that it begins. */
static int begins_tour(const struct section *s)
{
	return s->kind == SECTION_BIAS || s->kind == SECTION_GRAVITY || s->kind == SECTION_RESIDUAL || s->kind == SECTION_RATE;
}

void unparse_section(struct unparser *u, const struct section *s, struct text *out)
{
	const struct section *first = u->plan->dag->sections;

	if (emit_is_operation(u->emission))
		return;
	for (const struct section *x = first + u->sections; x <= s; x++)
		if (x == s || begins_tour(x)) {
			put_title(u->emission, u->function, x, out);
			put_formula(u, x, out);
		}
	u->sections = (size_t)(s - first) + 1;
}
