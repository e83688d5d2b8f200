#ifndef RNEAGEN_ANALYSIS_H
#define RNEAGEN_ANALYSIS_H
/* The first half of the passes: from the bytes of a URDF to the fused DAG of the torques, which eval.h evaluates. Each pass fills
   the members beside its name. rneagen.c runs them one by one; whoever compares a choice with another runs those that the choice
   changes once more. */

#include "dag/eval_model.h"
#include "draw/proven.h"
#include "dynamics/registry.h"
#include "rneagen.h"
#include "scene/outcome.h"

enum analysis_pass { PASS_URDF_READ, PASS_SCENE_PARSE, PASS_SCENE_SELECT, PASS_HOLDS_CHOOSE, PASS_ROBOT_SNAP, PASS_TREE_BUILD,
	PASS_PARAMS_CHOOSE, PASS_REQUEST_RESOLVE, PASS_DAG_BUILD, PASS_DAG_PRUNE, PASS_DAG_FUSE, ANALYSIS_PASSES };

/* By which constants the model is computed: the URDF's, or base parameters in frames of their own; and whether it was found out
   which of these costs less. */
struct params_choice {
	int is_base, is_auto;
	int is_left; /* set before the pass: the URDF's are taken whatever the scene says */
	long flops[2]; /* is_auto: of the request, by the URDF's and by base parameters */
};

/* Not to be moved once it has a tree. */
struct analysis {
	const char *urdf; /* `length` bytes */
	size_t length;
	struct rneagen_options options; /* `file` is never NULL */
	struct arena *arena;            /* of all that is made, but of `raw` */
	struct rneagen_error *error;
	struct robot robot;             /* urdf_read: as the file states it, and its warnings */
	struct scene scene;             /* scene_parse */
	struct adjust adjust;
	struct selection selection;     /* scene_select; is_body of its joints: holds_choose */
	struct outcome outcome;
	struct robot snapped;           /* robot_snap: what the tree is built from */
	struct tree stated;             /* tree_build: of the URDF's own frames and inertias */
	struct tree tree;               /* tree_build, params_choose; its gravity: request_resolve */
	struct params_choice params;          /* params_choose */
	struct eval_model model;        /* request_resolve: the text's arithmetic, of which wanted bounds speak */
	struct request request;
	struct proven dropped;          /* dag_prune, where it is proved: how much outputs change without the terms */
	struct dag raw;                 /* dag_build, dag_prune; until analysis_free_raw */
	/* dag_fuse: q, qd, qdd -> tau or what else is asked for, products joined to sums as in the text */
	struct dag dag;
	struct arena raw_arena, own;    /* private; own: by analysis_open */
};

/* One pass each, which may fail as what it calls. */
enum rneagen_code pass_urdf_read(struct analysis *a);
enum rneagen_code pass_scene_parse(struct analysis *a);
enum rneagen_code pass_scene_select(struct analysis *a);
enum rneagen_code pass_holds_choose(struct analysis *a);
enum rneagen_code pass_robot_snap(struct analysis *a);
enum rneagen_code pass_tree_build(struct analysis *a);
enum rneagen_code pass_params_choose(struct analysis *a);
enum rneagen_code pass_request_resolve(struct analysis *a);
enum rneagen_code pass_dag_build(struct analysis *a);
enum rneagen_code pass_dag_prune(struct analysis *a);
enum rneagen_code pass_dag_fuse(struct analysis *a);

/* These passes in their order, both ends included, until one fails. */
enum rneagen_code analysis_run(struct analysis *a, enum analysis_pass first, enum analysis_pass last);

/* A copy that shares all that was made, to be changed and run again in another arena. */
void analysis_copy(struct analysis *x, const struct analysis *a, struct arena *arena, struct rneagen_error *e);

/* All of them, from `length` bytes of URDF; of `o` what says which torques are wanted is used. On failure *a is empty.
   Errors: as rneagen_generate. */
enum rneagen_code analysis_open(struct analysis *a, const char *urdf, size_t length, const struct rneagen_options *o,
	struct rneagen_error *e);
void analysis_free(struct analysis *a);

/* Give back the DAG that is not fused: it takes the most memory of all. */
void analysis_free_raw(struct analysis *a);

/* What the scene chose and may not be meant, as warnings of the robot. */
enum rneagen_code analysis_warn(struct analysis *a);

/* What the fused DAG costs, an FMA for two, sines and cosines not counted. */
long analysis_flops(const struct analysis *a);

#endif
