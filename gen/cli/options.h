#ifndef RNEAGEN_OPTIONS_H
#define RNEAGEN_OPTIONS_H
/* What the command lines of all commands share: how options that say what to generate are read, and how what is wrong
   is told. */

#include "rneagen.h"
#include "scene/scene.h"
#include <getopt.h>

/* What getopt_long returns. A command's own options follow from OPTION_OWN on. */
enum option_key { OPTION_TARGET = 256, OPTION_PRECISION, OPTION_LAYOUT, OPTION_TRIG, OPTION_BASE, OPTION_MIMIC,
	OPTION_DUMP, OPTION_GRAVITY, OPTION_ORDER, OPTION_STRICT, OPTION_PARTS, OPTION_SEGMENTS, OPTION_LIMBS,
	OPTION_HELP, OPTION_VERSION, OPTION_QD_RANGE, OPTION_QDD_RANGE, OPTION_SCENE_FILE, OPTION_SCENE,
	OPTION_OWN = 512 };

/* Rows for getopt_long: what torques are wanted, whatever text they come from. */
#define OPTIONS_MODEL                                                                                                  \
	{"precision", required_argument, NULL, OPTION_PRECISION}, {"trig", required_argument, NULL, OPTION_TRIG},      \
	{"base", required_argument, NULL, OPTION_BASE}, {"gravity", required_argument, NULL, OPTION_GRAVITY},          \
	{"mimic", required_argument, NULL, OPTION_MIMIC}, {"order", required_argument, NULL, OPTION_ORDER},            \
	{"strict", no_argument, NULL, OPTION_STRICT}, {"scene", required_argument, NULL, OPTION_SCENE_FILE},           \
	{"root", required_argument, NULL, OPTION_SCENE + SCENE_ROOT},                                                  \
	{"tip", required_argument, NULL, OPTION_SCENE + SCENE_TIP},                                                    \
	{"beside", required_argument, NULL, OPTION_SCENE + SCENE_BESIDE},                                              \
	{"lock", required_argument, NULL, OPTION_SCENE + SCENE_LOCK},                                                  \
	{"lock-all-but", required_argument, NULL, OPTION_SCENE + SCENE_LOCK_ALL_BUT},                                  \
	{"fold", required_argument, NULL, OPTION_SCENE + SCENE_FOLD},                                                  \
	{"free", required_argument, NULL, OPTION_SCENE + SCENE_FREE},                                                  \
	{"want", required_argument, NULL, OPTION_SCENE + SCENE_WANT},                                                  \
	{"dense", no_argument, NULL, OPTION_SCENE + SCENE_DENSE},                                                      \
	{"derivatives", required_argument, NULL, OPTION_SCENE + SCENE_DERIVATIVES},                                    \
	{"dynamics", required_argument, NULL, OPTION_SCENE + SCENE_DYNAMICS},                                          \
	{"params", required_argument, NULL, OPTION_SCENE + SCENE_PARAMS},                                              \
	{"pose", required_argument, NULL, OPTION_SCENE + SCENE_POSE},                                                  \
	{"frame", required_argument, NULL, OPTION_SCENE + SCENE_FRAME},                                                \
	{"add-frame", required_argument, NULL, OPTION_SCENE + SCENE_ADD_FRAME},                                        \
	{"refine", required_argument, NULL, OPTION_SCENE + SCENE_REFINE},                                              \
	{"jvp", required_argument, NULL, OPTION_SCENE + SCENE_JVP},                                                    \
	{"vjp", required_argument, NULL, OPTION_SCENE + SCENE_VJP},                                                    \
	{"by", required_argument, NULL, OPTION_SCENE + SCENE_BY},                                                      \
	{"fext", required_argument, NULL, OPTION_SCENE + SCENE_FEXT},                                                  \
	{"fext-frame", required_argument, NULL, OPTION_SCENE + SCENE_FEXT_FRAME},                                      \
	{"contact", required_argument, NULL, OPTION_SCENE + SCENE_CONTACT},                                            \
	{"weld", required_argument, NULL, OPTION_SCENE + SCENE_WELD},                                                  \
	{"armature", required_argument, NULL, OPTION_SCENE + SCENE_ARMATURE},                                          \
	{"damping", no_argument, NULL, OPTION_SCENE + SCENE_DAMPING},                                                  \
	{"friction", optional_argument, NULL, OPTION_SCENE + SCENE_FRICTION},                                          \
	{"snap-angle", required_argument, NULL, OPTION_SCENE + SCENE_SNAP_ANGLE},                                      \
	{"round-constants", required_argument, NULL, OPTION_SCENE + SCENE_ROUND_CONSTANTS},                            \
	{"drop-below", required_argument, NULL, OPTION_SCENE + SCENE_DROP_BELOW},                                      \
	{"range", required_argument, NULL, OPTION_SCENE + SCENE_RANGE}

/* The lines of --help for what makes up a scene. */
#define OPTIONS_SCENE_HELP                                                                                             \
	"  --scene FILE               take the scene, options from here on without dashes, a line each, from a file:\n"      \
	"                             # begins a comment; a value with a # in it goes into \"quotes\"\n"                    \
	"  --root LINK                the subtree below LINK, whose frame is the world's\n"                            \
	"  --tip L1,L2,...            the chains from the root to these links; all joints beside them are held at zero\n" \
	"  --beside lock|drop         drop: what hangs beside the chains has no mass either\n"                         \
	"  --lock JOINT=VALUE         hold a joint; planar and floating joints take 3 and 7 numbers by commas\n"       \
	"  --lock-all-but J1,J2,...   hold all other joints at zero\n"                                                 \
	"  --fold NAME=VALUE          an input that is known: qdd=0, qd.JOINT=0, tau=0, gravity=0,0,0\n"                      \
	"  --free N1,N2,...           constants that become inputs: gravity, mass.LINK, inertia.LINK, payload.LINK,\n" \
	"                             offset.JOINT; armature, damping, friction, of all joints, or damping.JOINT;\n"   \
	"                             accel.LINK of one that stands;\n"                                                        \
	"                             NAME:batch one for all samples, NAME:sample one for each\n"                      \
	"  --want N1,N2,...           what is computed: tau, gravity, bias, wrench.JOINT, twist.LINK, accel.LINK, power,\n" \
	"                             kinetic, potential, regressor, dtau_dq, dtau_dqd, M, jvp, vjp; dtau_dNAME by what\n" \
	"                             is free;\n"                                                                         \
	"                             where things are: pose.LINK, jacobian.LINK, djacobian.LINK, com, vcom,\n"         \
	"                             com_jacobian, momentum, momentum_matrix, dmomentum; coriolis, opspace_inv.LINK,\n" \
	"                             opspace.LINK;\n"                                                                \
	"                             forward dynamics, with tau for an input: qdd, qdd_bound, Minv, dqdd_dq, dqdd_dqd,\n" \
	"                             dqdd_dNAME, contact.LINK, weld.LINK\n"                                          \
	"  --jvp N1,N2,...            derivatives of any of these outputs, one after another, times the input jvp_v;\n" \
	"                             --jvp vjp: second derivatives, those of --vjp times jvp_v\n"                    \
	"  --vjp N1,N2,...            the input vjp_v times their derivatives; in both, inputs that --fold gives stand still,\n" \
	"                             but for tau of qdd, which varies in all its rows, given or not\n"               \
	"  --by N1,N2,...             jvp and vjp by these inputs too, which --free or --fext names: payload.LINK, fext.LINK\n" \
	"  --dense                    matrices with the zeros of joints on different branches, M whole\n"             \
	"  --derivatives forward|recursion\n"                                                                         \
	"                             how dtau_dq and dtau_dqd are made; the one with fewer operations unless given\n" \
	"  --dynamics auto|factor|articulated\n"                                                                     \
	"                             how qdd is found: by factors of the mass matrix, by articulated bodies, or, auto,\n" \
	"                             by the one with fewer operations\n"                                              \
	"  --params urdf|base|auto    by which constants the model is computed: the URDF's inertias in its frames; base\n"    \
	"                             inertial parameters in frames of the text's own; auto: those of both that take fewer\n" \
	"                             operations. Unless given, base where that saves 7.5 % of them, of gradients in f64\n"    \
	"                             7 %, else urdf\n"                                                                    \
	"  --pose rows|quaternion     pose.LINK: the rows of [R p], unless given; or p, then x y z w\n"               \
	"  --frame link|world|world-aligned\n"                                                                       \
	"                             of jacobian.LINK, djacobian.LINK, opspace.LINK, contact.LINK, weld.LINK and --free\n" \
	"                             accel.LINK: the link's, unless given; the world's; the world's axes at the link's origin\n" \
	"  --add-frame NAME=LINK,X,Y,Z,R,P,Y\n"                                                                      \
	"                             a frame on a link, which --want takes where it takes a link\n"                 \
	"  --refine 0|1|1:f64|1:f32x2|1:same\n"                                                                      \
	"                             qdd after so many steps of refinement, up to 3; the residual in f64, in pairs of\n" \
	"                             floats, or in the text's own numbers; unless named in f64 where the text is in f32\n" \
	"  --fext L1,L2,...           external wrenches on these links\n"                                              \
	"  --fext-frame link|world    in whose axes\n"                                                                 \
	"  --contact L1,L2,...        forward dynamics in which the origins of these links stand still, held by forces that\n" \
	"                             --want contact.LINK tells; --frame says in whose axes\n"                         \
	"  --weld L1,L2,...           the links stand still as a whole, held by the wrenches of --want weld.LINK\n" \
	"  --armature FILE            rotor inertias: lines JOINT KG_M2; or --armature JOINT=KG_M2\n"                  \
	"  --damping                  of the URDF\n"                                                                   \
	"  --friction, --friction=WIDTH\n"                                                                             \
	"                             of the URDF, smoothed over this width in rad/s or m/s\n"                         \
	"  --snap-angle TOL           angles within TOL rad of a multiple of pi/2 are that multiple\n"                 \
	"  --round-constants DIGITS   so many significant digits of each constant\n"                                   \
	"  --drop-below FRACTION      leave out terms that together change no output by more than this fraction of its\n"  \
	"                             largest value: proved for all states within limits and --range;\n"                   \
	"                             FRACTION:sampled: each alone, in drawn samples; nothing is proved\n"                 \
	"  --range NAME=LO,HI         what an input is drawn from where a text is measured: q, qd, qdd, tau, q.JOINT,\n" \
	"                             gravity, mass.LINK, fext.LINK, ...; NAME[ROW] for one row\n"

/* Rows for getopt_long: what kind of text. */
#define OPTIONS_TEXT                                                                                                   \
	{"target", required_argument, NULL, OPTION_TARGET}, {"layout", required_argument, NULL, OPTION_LAYOUT},        \
	{"dump", required_argument, NULL, OPTION_DUMP}, {"parts", required_argument, NULL, OPTION_PARTS}, \
	{"segments", required_argument, NULL, OPTION_SEGMENTS}, {"limbs", required_argument, NULL, OPTION_LIMBS}

struct option_choice {
	const char *name; /* NULL ends a list */
	int value;
};

/* Print "COMMAND: what is wrong; see COMMAND --help" to standard error; returns 2, the exit status. */
int option_refuse(const char *command, const char *fmt, ...) RNEAGEN_PRINTF(2, 3);

/* The value that a word stands for; 2 and a message if it stands for none. */
int option_choose(const char *command, const char *option, const char *word, const struct option_choice *choices,
	int *value);

/* Take an option of OPTIONS_MODEL or OPTIONS_TEXT, or OPTION_QD_RANGE or OPTION_QDD_RANGE: 0; the exit status, 1 or 2,
   and a message; -1 if `key` is not one of them. What makes up the scene is gathered in o->scene, which option_free
   frees. */
int option_generate(const char *command, struct rneagen_options *o, int key, const char *word);

/* The file that an option reads; NULL: none. */
const char *option_file(int key, const char *word);

void option_free(struct rneagen_options *o);

/* Is the command line at fault, and not the robot or a file? The exit status is 2 then, else 1. */
int option_at_fault(enum rneagen_code code);

/* "COMMAND: KIND 'WORD' is not known; did you mean 'DASHES MEANT'?", of an option or a command; returns 2. */
int option_refuse_meant(const char *command, const char *kind, const char *word, const char *dashes, const char *meant);

/* The message for what getopt_long returned as ':' or '?' in an optstring that begins with ':', and of `options`; returns 2. */
int option_refuse_key(const char *command, int key, const char *word, const struct option *options);

#endif
