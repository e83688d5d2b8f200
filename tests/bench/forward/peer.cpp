/* Pinocchio's forward dynamics, for any robot. */
#include "peer.h"
#include <pinocchio/algorithm/aba-derivatives.hpp>
#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/multibody.hpp>
#include <pinocchio/serialization.hpp>
#include <string>

using vector = Eigen::Map<const Eigen::VectorXd>;

struct peer {
	pinocchio::Model model;
	pinocchio::Data data;

	explicit peer(const pinocchio::Model &m) : model(m), data(m)
	{
	}
};

struct peer *peer_open(const char *path)
{
	pinocchio::Model model;

	pinocchio::serialization::loadFromBinary(model, std::string(path));
	return new peer(model);
}

void peer_aba(struct peer *p, const double *q, int world)
{
	int nq = p->model.nq, nv = p->model.nv;

	pinocchio::aba(p->model, p->data, vector(q, nq), vector(q + nq, nv), vector(q + nq + nv, nv),
		world ? pinocchio::Convention::WORLD : pinocchio::Convention::LOCAL);
}

void peer_derivatives(struct peer *p, const double *q)
{
	int nq = p->model.nq, nv = p->model.nv;

	pinocchio::computeABADerivatives(p->model, p->data, vector(q, nq), vector(q + nq, nv), vector(q + nq + nv, nv));
}

double peer_qdd(const struct peer *p, int i)
{
	return p->data.ddq[i];
}

double peer_by(const struct peer *p, int qd, int i, int j)
{
	return qd ? p->data.ddq_dv(i, j) : p->data.ddq_dq(i, j);
}
