#include "continuum/io/body_log.h"

#include <fmt/format.h>

#include "continuum/io/archive.h"

namespace talus {

void BodyLog::add(const StepReport& report) {
  duration_ += report.dt;
  impulses_.resize(report.on_bodies.size());
  for (std::size_t b = 0; b < impulses_.size(); ++b) {
    impulses_[b].linear += report.on_bodies[b].linear;
    impulses_[b].angular += report.on_bodies[b].angular;
  }
}

nlohmann::json BodyLog::fields() const {
  Eigen::Matrix<double, 6, Eigen::Dynamic> rows(6, std::ssize(impulses_));
  for (Eigen::Index b = 0; b < rows.cols(); ++b) {
    const BodyImpulse& impulse = impulses_[static_cast<std::size_t>(b)];
    rows.col(b) << impulse.linear, impulse.angular;
  }
  ArchiveWriter archive;
  archive.number("duration", duration_);
  archive.list("impulses", rows);
  return archive.fields();
}

void BodyLog::restore(const nlohmann::json& fields, const std::string& where) {
  Eigen::Matrix<double, 6, Eigen::Dynamic> rows;
  ArchiveReader archive(fields, where);
  archive.number("duration", duration_);
  archive.list("impulses", rows);
  impulses_.clear();
  for (Eigen::Index b = 0; b < rows.cols(); ++b)
    impulses_.push_back({rows.col(b).head<3>(), rows.col(b).tail<3>()});
}

std::string BodyLog::header() {
  return "time_s,body,x_m,y_m,z_m,qw,qx,qy,qz,vx_m_s,vy_m_s,vz_m_s,wx_rad_s,wy_rad_s,wz_rad_s,"
         "fx_n,fy_n,fz_n,tx_n_m,ty_n_m,tz_n_m\n";
}

std::string BodyLog::rows(const State& state) {
  impulses_.resize(state.bodies.size());
  const double rate = duration_ > 0.0 ? 1.0 / duration_ : 0.0;
  std::string text;
  for (std::size_t b = 0; b < state.bodies.size(); ++b) {
    const Body& body = state.bodies[b];
    const Eigen::Vector3d &x = body.pose.position, &v = body.twist.velocity, &w = body.twist.angular_velocity;
    const Eigen::Quaterniond& q = body.pose.orientation;
    const Eigen::Vector3d force = rate * impulses_[b].linear, torque = rate * impulses_[b].angular;
    text += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", state.time,
                        body.name, x[0], x[1], x[2], q.w(), q.x(), q.y(), q.z(), v[0], v[1], v[2], w[0], w[1],
                        w[2], force[0], force[1], force[2], torque[0], torque[1], torque[2]);
  }
  duration_ = 0.0;
  impulses_.clear();
  return text;
}

}  // namespace talus
