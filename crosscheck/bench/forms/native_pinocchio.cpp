// Pinocchio's rnea and aba in a loop over states, compiled from its headers: no Python, no prebuilt library.
//
// Numbers of a body: its parent (0 is the ground), the kind of its joint (0 to 3: revolute about x, y, z, another axis;
// 4 to 7: prismatic likewise), the axis (3), the placement of the joint (rotation by rows, 9, and position, 3), mass (1),
// center of mass (3), tensor about it by rows (9).

#define BOOST_VARIANT_USE_RELAXED_GET_BY_DEFAULT  // Pinocchio looks for kinds of joints that are left out here

#include <cstdint>
#include <string>

#include <pinocchio/config.hpp>
#include <pinocchio/multibody.hpp>

#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/rnea.hpp>

#define EXPORTED extern "C" __attribute__((visibility("default")))

namespace {

// The kinds of joints that the robots have. All 25 of Pinocchio take minutes to compile and are no faster.
template <typename S, int O>
struct Kinds {
  using Scalar = S;
  static constexpr int Options = O;

  using JointModelVariant =
      boost::variant<pinocchio::JointModelRevoluteTpl<S, O, 0>, pinocchio::JointModelRevoluteTpl<S, O, 1>,
                     pinocchio::JointModelRevoluteTpl<S, O, 2>, pinocchio::JointModelRevoluteUnalignedTpl<S, O>,
                     pinocchio::JointModelPrismaticTpl<S, O, 0>, pinocchio::JointModelPrismaticTpl<S, O, 1>,
                     pinocchio::JointModelPrismaticTpl<S, O, 2>, pinocchio::JointModelPrismaticUnalignedTpl<S, O>>;
  using JointDataVariant =
      boost::variant<pinocchio::JointDataRevoluteTpl<S, O, 0>, pinocchio::JointDataRevoluteTpl<S, O, 1>,
                     pinocchio::JointDataRevoluteTpl<S, O, 2>, pinocchio::JointDataRevoluteUnalignedTpl<S, O>,
                     pinocchio::JointDataPrismaticTpl<S, O, 0>, pinocchio::JointDataPrismaticTpl<S, O, 1>,
                     pinocchio::JointDataPrismaticTpl<S, O, 2>, pinocchio::JointDataPrismaticUnalignedTpl<S, O>>;
};

using Model = pinocchio::ModelTpl<double, 0, Kinds>;
using Joint = Model::JointModel;
using Matrix3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
using Given = Eigen::Map<const Eigen::VectorXd>;
using Result = Eigen::Map<Eigen::VectorXd>;

constexpr int row_size = 30;

struct Robot {
  Model model;
  pinocchio::DataTpl<double, 0, Kinds> data;

  explicit Robot(const Model& built) : model(built), data(model) {}
};

Joint joint(int kind, const Eigen::Vector3d& axis) {
  switch (kind) {
    case 0: return Joint(pinocchio::JointModelRX());
    case 1: return Joint(pinocchio::JointModelRY());
    case 2: return Joint(pinocchio::JointModelRZ());
    case 3: return Joint(pinocchio::JointModelRevoluteUnaligned(axis));
    case 4: return Joint(pinocchio::JointModelPX());
    case 5: return Joint(pinocchio::JointModelPY());
    case 6: return Joint(pinocchio::JointModelPZ());
    default: return Joint(pinocchio::JointModelPrismaticUnaligned(axis));
  }
}

template <typename Algorithm>
void loop(void* robot, std::int64_t count, const double* q, const double* v, const double* x, double* out,
          Algorithm algorithm) {
  Robot& own = *static_cast<Robot*>(robot);
  const int n = own.model.nv;
  for (std::int64_t k = 0; k < count * n; k += n) {
    Result(out + k, n) = algorithm(own.model, own.data, Given(q + k, n), Given(v + k, n), Given(x + k, n));
  }
}

}  // namespace

EXPORTED const char* libraries() {
#if defined(__clang__)
  static const std::string compiler = "clang " __clang_version__;
#else
  static const std::string compiler = "gcc " __VERSION__;
#endif
  static const std::string said = std::string("headers of Pinocchio ") + PINOCCHIO_VERSION + " and Eigen " +
                                  std::to_string(EIGEN_WORLD_VERSION) + "." + std::to_string(EIGEN_MAJOR_VERSION) +
                                  "." + std::to_string(EIGEN_MINOR_VERSION) + ", " + compiler;
  return said.c_str();
}

EXPORTED void* make_robot(int bodies, const double* rows, const double* gravity) {
  Model model;
  model.gravity.linear() = Eigen::Map<const Eigen::Vector3d>(gravity);
  for (int k = 0; k < bodies; ++k, rows += row_size) {
    const Eigen::Map<const Eigen::Vector3d> axis(rows + 2), position(rows + 14), center(rows + 18);
    const Eigen::Map<const Matrix3> rotation(rows + 5), tensor(rows + 21);
    const pinocchio::SE3 placement{Eigen::Matrix3d(rotation), Eigen::Vector3d(position)};
    const auto id = model.addJoint(static_cast<pinocchio::JointIndex>(rows[0]), joint(static_cast<int>(rows[1]), axis),
                                   placement, "joint" + std::to_string(k + 1));
    model.appendBodyToJoint(id, pinocchio::Inertia(rows[17], center, pinocchio::Symmetric3(Eigen::Matrix3d(tensor))),
                            pinocchio::SE3::Identity());
  }
  return new Robot(model);
}

EXPORTED void rnea_loop(void* robot, std::int64_t count, const double* q, const double* v, const double* a,
                        double* tau) {
  loop(robot, count, q, v, a, tau, [](auto&&... arguments) -> const auto& { return pinocchio::rnea(arguments...); });
}

EXPORTED void aba_loop(void* robot, std::int64_t count, const double* q, const double* v, const double* tau,
                       double* a) {
  loop(robot, count, q, v, tau, a, [](auto&&... arguments) -> const auto& { return pinocchio::aba(arguments...); });
}
