#include "implicit/second_order_system.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/collectives.h"
#include "floe/files/log.h"
#include "model/newton.h"
#include "run/numbers.h"

namespace floe {

template <class Space>
SecondOrderSystem<Space>::SecondOrderSystem(Model<Space>& model, State<Space>& state)
    : model_(model),
      part_(model.part()),
      state_(state),
      turning_(model),
      tangent_(part_, model.prescribed(), model.length_scale(), typical_stiffness(model),
               tangent_options()),
      wrenches_(static_cast<std::size_t>(part_.local)),
      share_(static_cast<std::size_t>(part_.local)),
      owned_(static_cast<std::size_t>(part_.owned)),
      length_(model.length_scale()),
      values_(static_cast<std::size_t>(part_.local) * unknowns),
      rates_(values_),
      accelerations_(values_) {
  for (std::int32_t b = 0; b < part_.owned; ++b) {
    double sum = 0;
    for (const auto& force : model.forces()) {
      if (const auto* role = force->roles().step) sum += role->stiffness_bound(b);
    }
    stiffness_.push_back(sum);
  }
  for (std::size_t k = 0; k < owned_ * unknowns; ++k) {
    if (is_held(k)) held_.push_back(k);
  }
  attach_rigid_modes(model, model.prescribed(), tangent_.matrix());
  for (Handle<Vec>* vector : {&assembled_.x, &assembled_.v, &assembled_.a}) *vector = make_vector();
}

template <class Space>
Handle<Vec> SecondOrderSystem<Space>::make_vector() const {
  Handle<Vec> vector;
  check(MatCreateVecs(tangent_.matrix(), vector.put(), nullptr));
  return vector;
}

/// Rotation unknowns of a body in rad, or their rates in rad/s and rad/s^2.
template <class Space>
auto SecondOrderSystem<Space>::turn_of(std::span<const double> vector, std::size_t body) const
    -> TurnVector {
  return TurnVector(&vector[body * unknowns + moves]) / length_;
}

template <class Space>
auto SecondOrderSystem<Space>::moment_of(const Wrenches<Space>& wrenches, std::size_t body) const
    -> TurnVector {
  return turning_.to_frame(body, state_.record(body), TurnVector(wrenches.of(body) + moves));
}

template <class Space>
void SecondOrderSystem<Space>::begin(Vec x, Vec v) {
  check(VecZeroEntries(x));
  const Bodies& all = part_.bodies;
  {
    const Numbers rates(v);
    for (std::size_t b = 0; b < owned_; ++b) {
      double* to = &(*rates)[b * unknowns];
      // At rest all frames are those of the world.
      for (std::size_t k = 0; k < unknowns; ++k) to[k] = 0;
      if (!all.velocity.empty()) {
        for (std::size_t k = 0; k < moves; ++k) to[k] = all.velocity[b][k];
      }
      if (!all.angular_velocity.empty()) {
        for (std::size_t k = 0; k < Turn::size; ++k)
          to[moves + k] = length_ * all.angular_velocity[b][k + 3 - Turn::size];
      }
    }
  }
  const Handle<Vec> a = make_vector(), own = make_vector();
  prescribe(state_.time, {x, v, a, own});
}

template <class Space>
void SecondOrderSystem<Space>::acceleration(double time, Vec x, Vec v, Vec a) {
  take(time, x, v);
  model_.evaluate(state_, wrenches_);
  model_.prescribe_accelerations(time, accelerations_);
  const ReadNumbers rates(v);
  const Numbers to(a);
  for (std::size_t b = 0; b < owned_; ++b) {
    for (std::size_t k = b * unknowns; k < b * unknowns + moves; ++k)
      (*to)[k] = is_held(k) ? accelerations_[k] : wrenches_.at(k) / model_.inertial_mass()[b];
    const TurnVector given(&accelerations_[b * unknowns + moves]);
    const TurnVector turn = turning_.acceleration(b, state_.record(b), turn_of(*rates, b),
                                                  moment_of(wrenches_, b), given);
    for (std::size_t k = 0; k < Turn::size; ++k)
      (*to)[b * unknowns + moves + k] = length_ * turn[static_cast<Eigen::Index>(k)];
  }
}

template <class Space>
void SecondOrderSystem<Space>::prescribe(double time, const LieAlphaStage& stage) const {
  model_.prescribe(time, values_);
  model_.prescribe_rates(time, rates_);
  model_.prescribe_accelerations(time, accelerations_);
  // All ranks must make these views, also those that hold no unknown: see Numbers.
  const Numbers x(stage.x), v(stage.v), a(stage.a), own(stage.own);
  for (const std::size_t k : held_) {
    const double scale = is_displacement(k) ? 1.0 : length_;
    (*x)[k] = scale * values_[k];
    (*v)[k] = scale * rates_[k];
    (*a)[k] = scale * accelerations_[k];
    (*own)[k] = 0;
  }
}

template <class Space>
void SecondOrderSystem<Space>::take(double time, Vec x, Vec v) {
  const ReadNumbers places(x), rates(v);
  for (std::size_t b = 0; b < owned_; ++b) {
    double* record = state_.record(b);
    const std::size_t at = b * unknowns;
    std::copy_n(&(*places)[at], moves, record + Space::displacement);
    std::copy_n(&(*rates)[at], moves, record + Space::velocity);
    turning_.take(b, turn_of(*places, b), turn_of(*rates, b), record);
  }
  state_.set_time(time);
  part_.ghosts.update(state_.records, Space::record);
}

template <class Space>
void SecondOrderSystem<Space>::rebase(Vec x) {
  const ReadNumbers places(x);
  for (std::size_t b = 0; b < owned_; ++b)
    turning_.rebase(b, turn_of(*places, b), state_.record(b));
}

template <class Space>
void SecondOrderSystem<Space>::residual(double time, Vec x, Vec v, Vec a, Vec f) {
  const Timed timed(Event::forces);
  take(time, x, v);
  const typename Model<Space>::Squares external = model_.evaluate_apart(state_, wrenches_, share_);
  sizes2_ = external.together;
  rounding2_ = external.apart;
  const ReadNumbers places(x), rates(v), accelerations(a);
  const Numbers to(f);
  std::array<double, unknowns> inertia{};
  for (std::size_t b = 0; b < owned_; ++b) {
    const double mass = model_.inertial_mass()[b];
    const TurnVector turn = turning_.inertia_moment(b, state_.record(b), turn_of(*rates, b),
                                                    turn_of(*accelerations, b));
    const TurnVector moment = moment_of(wrenches_, b);
    double moved2 = 0, speed2 = 0;
    for (std::size_t k = 0; k < unknowns; ++k) {
      const std::size_t at = b * unknowns + k;
      const auto r = static_cast<Eigen::Index>(k - moves);
      inertia[k] = k < moves ? mass * (*accelerations)[at] : turn[r] / length_;
      const double wrench = k < moves ? wrenches_.at(at) : moment[r] / length_;
      (*to)[at] = is_held(at) ? 0.0 : inertia[k] - wrench;
      sizes2_ += is_held(at) ? wrench * wrench : inertia[k] * inertia[k];
      moved2 += (*places)[at] * (*places)[at];
      speed2 += (*rates)[at] * (*rates)[at];
    }
    const double pull = stiffness_[b], push = mass * assembled_.by_velocity;
    rounding2_ += pull * pull * moved2 + push * push * speed2;
  }
}

template <class Space>
double SecondOrderSystem<Space>::tolerance(double relative, double absolute) const {
  const auto all = sum_over_ranks(std::array{sizes2_, rounding2_}, part_.comm);
  constexpr double rounding = std::numeric_limits<double>::epsilon();
  return std::max({relative * std::sqrt(all[0]), rounding * std::sqrt(all[1]), absolute});
}

/// Sets the frames of all local bodies, for derivatives to places and to velocities. Collective.
template <class Space>
void SecondOrderSystem<Space>::set_frames(std::span<const double> x, double by_velocity) {
  const auto local = static_cast<std::size_t>(part_.local);
  increments_.resize(local * Turn::size);
  for (std::size_t b = 0; b < owned_; ++b) {
    const TurnVector theta = turning_.increment(b, turn_of(x, b));
    std::copy_n(theta.data(), Turn::size, &increments_[b * Turn::size]);
  }
  part_.ghosts.update(increments_, static_cast<int>(Turn::size));
  frames_.clear();
  velocity_frames_.clear();
  const bool symmetric = tangent_.symmetric();
  for (std::size_t b = 0; b < local; ++b) {
    const TurnVector theta(&increments_[b * Turn::size]);
    const double* record = state_.record(b);
    frames_.push_back(turning_.frame(b, record, theta, symmetric));
    velocity_frames_.push_back(turning_.velocity_frame(b, record, theta, by_velocity, symmetric));
  }
}

template <class Space>
void SecondOrderSystem<Space>::add_inertia(std::span<const double> x, std::span<const double> v,
                                           std::span<const double> a, double by_velocity,
                                           double by_acceleration) {
  for (std::size_t b = 0; b < owned_; ++b) {
    typename Tangent<Space>::Block block{};
    for (std::size_t k = 0; k < moves; ++k)
      block[k * unknowns + k] = by_acceleration * model_.inertial_mass()[b];
    const auto turn = turning_.tangent(b, state_.record(b), turning_.increment(b, turn_of(x, b)),
                                       turn_of(v, b), turn_of(a, b), moment_of(wrenches_, b),
                                       by_velocity, by_acceleration, tangent_.symmetric());
    for (std::size_t r = 0; r < Turn::size; ++r) {
      for (std::size_t c = 0; c < Turn::size; ++c)
        block[(moves + r) * unknowns + moves + c] =
            turn(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c));
    }
    tangent_.add_body(static_cast<std::int32_t>(b), block);
  }
}

template <class Space>
void SecondOrderSystem<Space>::assemble(double time, Vec x, Vec v, Vec a, double by_velocity,
                                        double by_acceleration) {
  const Timed timed(Event::tangent);
  assembled_.time = time;
  assembled_.by_velocity = by_velocity;
  assembled_.by_acceleration = by_acceleration;
  check(VecCopy(x, assembled_.x));
  check(VecCopy(v, assembled_.v));
  check(VecCopy(a, assembled_.a));
  assembled_.references = turning_.references();
  take(time, x, v);
  model_.evaluate(state_, wrenches_);
  const ReadNumbers places(x), rates(v), accelerations(a);
  tangent_.begin();
  const bool turning = model_.kinematics() != Kinematics::linear;
  if (turning) set_frames(*places, by_velocity);
  tangent_.weigh(1, frames_);
  for (const auto& force : model_.forces()) {
    if (const auto* role = force->roles().tangent) (void)role->add_tangent(state_, tangent_);
  }
  tangent_.weigh(by_velocity, velocity_frames_);
  for (const auto& force : model_.forces()) {
    if (const auto* role = force->roles().damping) role->add_damping(state_, tangent_);
  }
  tangent_.weigh(1, {});
  add_inertia(*places, *rates, *accelerations, by_velocity, by_acceleration);
  tangent_.end();
}

template <class Space>
void SecondOrderSystem<Space>::put_in_frame(const Wrenches<Space>& wrenches,
                                            std::vector<double>& values) const {
  values.resize(owned_ * unknowns);
  for (std::size_t b = 0; b < owned_; ++b) {
    const TurnVector moment = moment_of(wrenches, b);
    for (std::size_t k = 0; k < unknowns; ++k)
      values[b * unknowns + k] =
          k < moves ? wrenches.of(b)[k] : moment[static_cast<Eigen::Index>(k - moves)] / length_;
  }
}

template <class Space>
void SecondOrderSystem<Space>::forces(Vec v, Vec a, const Wrenches<Space>& wrenches,
                                      Forces& all) const {
  const ReadNumbers rates(v), accelerations(a);
  put_in_frame(wrenches, all.reaction);
  all.inertia.resize(owned_ * unknowns);
  for (std::size_t b = 0; b < owned_; ++b) {
    const TurnVector turn = turning_.inertia_moment(b, state_.record(b), turn_of(*rates, b),
                                                    turn_of(*accelerations, b));
    for (std::size_t k = 0; k < unknowns; ++k) {
      const std::size_t at = b * unknowns + k;
      all.inertia[at] = k < moves ? model_.inertial_mass()[b] * (*accelerations)[at]
                                  : turn[static_cast<Eigen::Index>(k - moves)] / length_;
      all.reaction[at] = is_held(at) ? all.inertia[at] - all.reaction[at] : 0.0;
    }
  }
  all.losses.resize(model_.forces().size());
  for (std::size_t k = 0; k < all.losses.size(); ++k) {
    const auto* role = model_.forces()[k]->roles().damping;
    if (role == nullptr) continue;
    std::fill(share_.values.begin(), share_.values.end(), 0.0);
    role->add_losses(state_, share_);
    put_in_frame(share_, all.losses[k]);
  }
}

template <class Space>
double SecondOrderSystem<Space>::kinetic(Vec v) const {
  const ReadNumbers rates(v);
  double sum = 0;
  for (std::size_t b = 0; b < owned_; ++b) {
    double speed2 = 0;
    for (std::size_t k = 0; k < moves; ++k) {
      const double speed = (*rates)[b * unknowns + k];
      speed2 += speed * speed;
    }
    sum += 0.5 * model_.inertial_mass()[b] * speed2 +
           turning_.kinetic(b, state_.record(b), turn_of(*rates, b));
  }
  return sum;
}

template <class Space>
double SecondOrderSystem<Space>::largest_speed2() const {
  // The sum keeps numbers that are not finite, which a maximum would lose.
  double largest = 0, sum = 0;
  for (std::size_t b = 0; b < owned_; ++b) {
    double speed2 = 0;
    for (std::size_t k = 0; k < moves; ++k) {
      const double speed = state_.record(b)[Space::velocity + k];
      speed2 += speed * speed;
    }
    largest = std::max(largest, speed2);
    sum += speed2;
  }
  return std::isfinite(sum) ? largest : sum;
}

template <class Space>
void SecondOrderSystem<Space>::persist(Archive& archive) {
  archive.enter("matrix");
  archive.common("time", assembled_.time);
  archive.common("by_velocity", assembled_.by_velocity);
  archive.common("by_acceleration", assembled_.by_acceleration);
  if (assembled_.by_acceleration == 0) return;
  floe::persist(archive, part_, "x", assembled_.x, n);
  floe::persist(archive, part_, "v", assembled_.v, n);
  floe::persist(archive, part_, "a", assembled_.a, n);
  assembled_.references.resize(owned_ * Turn::reference_size);
  archive.rows("references", owned_bodies(part_), assembled_.references, Turn::reference_size);
  if (!archive.loading()) return;
  turning_.set_references(assembled_.references);
  const double now = state_.time;
  assemble(assembled_.time, assembled_.x, assembled_.v, assembled_.a, assembled_.by_velocity,
           assembled_.by_acceleration);
  state_.set_time(now);
}

template class SecondOrderSystem<Spatial>;

}  // namespace floe
