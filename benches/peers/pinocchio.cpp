// Times Pinocchio's standard path to the observer's terms; called by run.py.
//
//   peer-pinocchio ROBOT STATES SECONDS DUMP      prints the least time per pass, ns
//
// crba, computeCoriolisMatrix and computeGeneralizedGravity, then p = M dq and C^T dq. The model is
// built from a listing of Pinocchio's own parsed model, with the joint types its parser chose, so
// that only headers are needed and every compiler option is free of the ABI of the packaged
// library. Both conventions of crba are timed; the faster one counts.

#include <chrono>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include <pinocchio/multibody.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/rnea.hpp>

namespace pin = pinocchio;
using Eigen::VectorXd;

static pin::JointModel joint(const std::string & kind, const Eigen::Vector3d & axis)
{
  if (kind == "JointModelRX") return pin::JointModelRX();
  if (kind == "JointModelRY") return pin::JointModelRY();
  if (kind == "JointModelRZ") return pin::JointModelRZ();
  if (kind == "JointModelPX") return pin::JointModelPX();
  if (kind == "JointModelPY") return pin::JointModelPY();
  if (kind == "JointModelPZ") return pin::JointModelPZ();
  if (kind == "JointModelRevoluteUnaligned") return pin::JointModelRevoluteUnaligned(axis);
  if (kind == "JointModelPrismaticUnaligned") return pin::JointModelPrismaticUnaligned(axis);
  throw std::runtime_error("joint type " + kind);
}

static pin::Model read_model(const char * path)
{
  std::ifstream in(path);
  pin::Model model;
  Eigen::Vector3d gravity;
  size_t n;
  in >> n >> gravity[0] >> gravity[1] >> gravity[2];
  model.gravity.linear() = gravity;
  for (size_t i = 0; i < n; ++i)
  {
    std::string name, kind;
    size_t parent;
    Eigen::Vector3d axis, t, com;
    Eigen::Matrix3d r, inertia;
    double mass;
    in >> name >> kind >> parent >> axis[0] >> axis[1] >> axis[2];
    for (int k = 0; k < 9; ++k) in >> r(k / 3, k % 3);
    in >> t[0] >> t[1] >> t[2] >> mass >> com[0] >> com[1] >> com[2];
    for (int k = 0; k < 9; ++k) in >> inertia(k / 3, k % 3);
    if (!in) throw std::runtime_error("short model file");
    const auto id = model.addJoint(parent, joint(kind, axis), pin::SE3(r, t), name);
    model.appendBodyToJoint(id, pin::Inertia(mass, com, inertia), pin::SE3::Identity());
  }
  return model;
}

struct Terms
{
  VectorXd p, ct_dq, g;
};

// noinline: the compiler sees one pass at a time, as a control loop's does.
__attribute__((noinline)) static void pass(
  const pin::Model & model, pin::Data & data, const VectorXd & q, const VectorXd & dq,
  pin::Convention convention, Terms & out)
{
  pin::crba(model, data, q, convention);
  pin::computeCoriolisMatrix(model, data, q, dq);
  pin::computeGeneralizedGravity(model, data, q);
  out.p.noalias() = data.M.selfadjointView<Eigen::Upper>() * dq;
  out.ct_dq.noalias() = data.C.transpose() * dq;
  out.g = data.g;
}

int main(int argc, char ** argv)
{
  if (argc != 5) return 2;
  const pin::Model model = read_model(argv[1]);
  pin::Data data(model);
  const int n = model.nv;
  std::vector<std::pair<VectorXd, VectorXd>> cases;
  std::ifstream states(argv[2]);
  std::string line;
  std::getline(states, line); // names: the order is already the model's
  while (std::getline(states, line))
  {
    std::istringstream in(line);
    VectorXd q(n), dq(n);
    for (int i = 0; i < n; ++i) in >> q[i];
    for (int i = 0; i < n; ++i) in >> dq[i];
    cases.emplace_back(q, dq);
  }
  Terms terms{VectorXd::Zero(n), VectorXd::Zero(n), VectorXd::Zero(n)};
  std::ofstream dump(argv[4]);
  dump << std::setprecision(17);
  for (const auto & c : cases)
  {
    pass(model, data, c.first, c.second, pin::Convention::LOCAL, terms);
    dump << terms.p.transpose() << " " << terms.ct_dq.transpose() << " " << terms.g.transpose() << "\n";
  }

  using clock = std::chrono::steady_clock;
  const double seconds = std::stod(argv[3]);
  double best = 1e300, sink = 0;
  const int repeats = 1; // batches well under a time slice: the least one is undisturbed
  for (const auto convention : {pin::Convention::LOCAL, pin::Convention::WORLD})
  {
    const auto end = clock::now() + std::chrono::duration<double>(0.5 * seconds);
    while (clock::now() < end)
    {
      const auto start = clock::now();
      for (int k = 0; k < repeats; ++k)
        for (const auto & c : cases)
        {
          pass(model, data, c.first, c.second, convention, terms);
          sink += terms.p[0] + terms.ct_dq[0] + terms.g[0];
        }
      const std::chrono::duration<double, std::nano> spent = clock::now() - start;
      best = std::min(best, spent.count() / (repeats * double(cases.size())));
    }
  }
  std::cout << best << "\n";
  return sink == 0.123456; // keeps the sums alive
}
