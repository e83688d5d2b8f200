#ifndef RNEAGEN_OPS_H
#define RNEAGEN_OPS_H
/* The operations of the expression DAG, one row each. WIDEN takes a number over into a type with more bits, without an error,
   and NARROW rounds it back. PACK makes lanes of two PAIRs of numbers, and LANE0 to LANE3 are one of them:
   X(name, arguments, commutes, binding strength of the text that shows it) */
#define DAG_OPS(X)                                                                                                     \
	X(CONST, 0, 0, 4)                                                                                              \
	X(INPUT, 0, 0, 4)                                                                                              \
	X(NEG, 1, 0, 3)                                                                                                \
	X(ADD, 2, 1, 1)                                                                                                \
	X(SUB, 2, 0, 1)                                                                                                \
	X(MUL, 2, 1, 2)                                                                                                \
	X(FMA, 3, 0, 4)                                                                                                \
	X(DIV, 2, 0, 2)                                                                                                \
	X(SQRT, 1, 0, 4)                                                                                               \
	X(ABS, 1, 0, 4)                                                                                                \
	X(ANEW, 1, 0, 4)                                                                                               \
	X(SIN, 1, 0, 4)                                                                                                \
	X(COS, 1, 0, 4)                                                                                                \
	X(WIDEN, 1, 0, 3)                                                                                              \
	X(NARROW, 1, 0, 3)                                                                                             \
	X(PAIR, 2, 0, 4)                                                                                               \
	X(PACK, 2, 0, 4)                                                                                               \
	X(LANE0, 1, 0, 4)                                                                                              \
	X(LANE1, 1, 0, 4)                                                                                              \
	X(LANE2, 1, 0, 4)                                                                                              \
	X(LANE3, 1, 0, 4)

enum op {
#define DAG_OP_ENUM(name, arity, commutes, strength) OP_##name,
	DAG_OPS(DAG_OP_ENUM)
#undef DAG_OP_ENUM
	OP_COUNT
};

/* arguments, binding strength (4 atom, 3 sign, 2 product, 1 sum), and the name in dumps */
extern const unsigned char op_arity[OP_COUNT], op_commutes[OP_COUNT], op_strength[OP_COUNT];
extern const char *const op_name[OP_COUNT];

#endif
