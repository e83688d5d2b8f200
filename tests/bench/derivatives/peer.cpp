#include "peer.h"
#include <cstdio>
#include <exception>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/rnea-derivatives.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include <pinocchio/multibody.hpp>
#include <pinocchio/serialization.hpp>

using vector = Eigen::Map<const Eigen::VectorXd>;

struct peer {
	pinocchio::Model model;
	pinocchio::Data data;

	explicit peer(const pinocchio::Model &m) : model(m), data(m)
	{
	}
};

extern "C" struct peer *peer_open(const char *path)
{
	try {
		pinocchio::Model model;

		pinocchio::serialization::loadFromBinary(model, std::string(path));
		return new peer(model);
	} catch (const std::exception &e) {
		std::fprintf(stderr, "%s: %s\n", path, e.what());
		return nullptr;
	}
}

extern "C" void peer_close(struct peer *p)
{
	delete p;
}

extern "C" int peer_nq(const struct peer *p)
{
	return p->model.nq;
}

extern "C" int peer_nv(const struct peer *p)
{
	return p->model.nv;
}

extern "C" const char *peer_version(void)
{
	return PINOCCHIO_VERSION;
}

extern "C" void peer_rnea(struct peer *p, const double *q, const double *qd, const double *qdd)
{
	int nq = p->model.nq, nv = p->model.nv;

	pinocchio::rnea(p->model, p->data, vector(q, nq), vector(qd, nv), vector(qdd, nv));
}

extern "C" void peer_crba_local(struct peer *p, const double *q)
{
	pinocchio::crba(p->model, p->data, vector(q, p->model.nq), pinocchio::Convention::LOCAL);
}

extern "C" void peer_crba_world(struct peer *p, const double *q)
{
	pinocchio::crba(p->model, p->data, vector(q, p->model.nq), pinocchio::Convention::WORLD);
}

extern "C" void peer_derivatives(struct peer *p, const double *q, const double *qd, const double *qdd)
{
	int nq = p->model.nq, nv = p->model.nv;

	pinocchio::computeRNEADerivatives(p->model, p->data, vector(q, nq), vector(qd, nv), vector(qdd, nv));
}

extern "C" double peer_element(const struct peer *p, enum peer_result result, int i, int j)
{
	switch (result) {
	case PEER_TAU:
		return p->data.tau[i];
	case PEER_DQ:
		return p->data.dtau_dq(i, j);
	case PEER_DQD:
		return p->data.dtau_dv(i, j);
	default:
		return p->data.M(i < j ? i : j, i < j ? j : i);
	}
}
