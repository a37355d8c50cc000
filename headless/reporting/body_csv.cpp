#include "headless/reporting/body_csv.h"

#include <charconv>
#include <cstdint>
#include <string>

#include "sim_cuda/world.h"

namespace collidoscope {
namespace {

/// Buffers rows and writes them to the sink in blocks.
class CsvRows {
 public:
  CsvRows(const TextSink& sink, std::string_view header) : sink_(sink) { (text_ += header) += '\n'; }
  CsvRows(const CsvRows&) = delete;
  CsvRows& operator=(const CsvRows&) = delete;

  CsvRows& begin(std::size_t id) {
    text_ += std::to_string(id);
    return *this;
  }
  CsvRows& operator<<(double number) {
    char digits[32];  // the longest shortest-form double has 24 characters
    const auto end = std::to_chars(digits, digits + sizeof digits, number).ptr;
    text_ += ',';
    text_.append(digits, end);
    return *this;
  }
  template <int rows, int columns>
  CsvRows& operator<<(const Eigen::Matrix<double, rows, columns>& matrix) {
    for (int row = 0; row < rows; ++row)
      for (int column = 0; column < columns; ++column) *this << matrix(row, column);
    return *this;
  }
  void end() {
    constexpr std::size_t piece = 1 << 16;
    text_ += '\n';
    if (text_.size() >= piece) flush();
  }
  void flush() {
    sink_(text_);
    text_.clear();
  }

 private:
  const TextSink& sink_;
  std::string text_;
};

}  // namespace

void write_body_states(World& world, const TextSink& sink) {
  const InitialBodies& fixed = world.initial();
  const BodyStates states = world.bodies();
  CsvRows rows(sink, "id,radius,mass,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz");
  for (std::size_t id = 0; id < fixed.size(); ++id) {
    const Quaterniond& q = states.orientation[id];
    rows.begin(id) << fixed.radius[id] << fixed.mass[id] << states.position[id] << q.w() << q.x() << q.y()
                   << q.z() << states.velocity[id] << states.angular_velocity[id];
    rows.end();
  }
  rows.flush();
}

void write_body_dynamics(World& world, const TextSink& sink) {
  const InitialBodies& fixed = world.initial();
  const BodyStates states = world.bodies();
  const Vector3d gravity = world.effects().gravity ? world.scene().physics.gravity : Vector3d(0, 0, 0);
  CsvRows rows(sink,
               "id,mass,x,y,z,r00,r01,r02,r10,r11,r12,r20,r21,r22,px,py,pz,lx,ly,lz,"
               "i00,i01,i02,i10,i11,i12,i20,i21,i22,fx,fy,fz,tx,ty,tz");
  for (std::size_t id = 0; id < fixed.size(); ++id) {
    const bool moved = !fixed.motion.empty() && fixed.motion[id] != Motion::dynamic;  // kinematic or fixed
    const double mass = moved ? 0 : fixed.mass[id], radius = fixed.radius[id];
    const double ball = 0.4 * mass * radius * radius;
    const Vector3d moments = moved || fixed.inertia.empty() ? Vector3d(ball, ball, ball) : fixed.inertia[id];
    const Matrix3d r = states.orientation[id].toRotationMatrix();
    const Matrix3d inertia = r * moments.asDiagonal() * r.transpose();
    const Matrix3d inverse = moved ? Matrix3d(Matrix3d::Zero())
                                   : Matrix3d(r * moments.cwiseInverse().asDiagonal() * r.transpose());
    const Vector3d momentum = mass * states.velocity[id];
    const Vector3d angular_momentum = inertia * states.angular_velocity[id];
    const Vector3d force = mass * gravity, torque(0, 0, 0);
    rows.begin(id) << mass << states.position[id] << r << momentum << angular_momentum << inverse << force
                   << torque;
    rows.end();
  }
  rows.flush();
}

}  // namespace collidoscope
