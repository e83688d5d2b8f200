/* Pinocchio's kinematics, for any robot. */
#include "peer.h"
#include <pinocchio/algorithm/center-of-mass.hpp>
#include <pinocchio/algorithm/centroidal.hpp>
#include <pinocchio/algorithm/frames.hpp>
#include <pinocchio/algorithm/kinematics.hpp>
#include <pinocchio/multibody.hpp>
#include <pinocchio/serialization.hpp>
#include <string>

using vector = Eigen::Map<const Eigen::VectorXd>;

struct peer {
	pinocchio::Model model;
	pinocchio::Data data;
	pinocchio::FrameIndex frame;
	Eigen::Matrix<double, 6, Eigen::Dynamic> J;

	peer(const pinocchio::Model &m, int f) : model(m), data(m), frame((pinocchio::FrameIndex)f), J(6, m.nv)
	{
		J.setZero();
	}
};

struct peer *peer_open(const char *path, int frame)
{
	pinocchio::Model model;

	pinocchio::serialization::loadFromBinary(model, std::string(path));
	return new peer(model, frame);
}

void peer_poses(struct peer *p, const double *q)
{
	pinocchio::forwardKinematics(p->model, p->data, vector(q, p->model.nq));
}

void peer_frames(struct peer *p, const double *q)
{
	pinocchio::framesForwardKinematics(p->model, p->data, vector(q, p->model.nq));
}

void peer_jacobian(struct peer *p, const double *q)
{
	pinocchio::computeFrameJacobian(p->model, p->data, vector(q, p->model.nq), p->frame, pinocchio::LOCAL, p->J);
}

void peer_com_jacobian(struct peer *p, const double *q)
{
	pinocchio::jacobianCenterOfMass(p->model, p->data, vector(q, p->model.nq), false);
}

void peer_momentum_matrix(struct peer *p, const double *q)
{
	pinocchio::computeCentroidalMap(p->model, p->data, vector(q, p->model.nq));
}

double peer_pose(const struct peer *p, int function, int number, int i, int j)
{
	const auto &at = function == POSES ? p->data.oMi[(size_t)number] : p->data.oMf[(size_t)number];

	return j < 3 ? at.rotation()(i, j) : at.translation()(i);
}

double peer_element(const struct peer *p, int function, int i, int j)
{
	return function == JACOBIAN ? p->J(i, j) : function == COM_JACOBIAN ? p->data.Jcom(i, j) : p->data.Ag(i, j);
}
