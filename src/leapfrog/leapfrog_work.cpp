#include "leapfrog/leapfrog_work.h"

namespace floe {

template <class Space>
LeapfrogWork<Space>::LeapfrogWork(std::span<const std::unique_ptr<Force<Space>>> forces,
                                  std::span<double> works)
    : works_(works), powers_(works.size()), kept_(works.size()), later_(works.size()) {
  std::size_t first = 0;
  for (const auto& force : forces) {
    const DoesWork<Space>* role = force->roles().work;
    if (role == nullptr) continue;
    workers_.push_back({role, first, role->works()});
    first += role->works();
  }
}

template <class Space>
void LeapfrogWork<Space>::Worker::ask(std::span<double> powers, std::span<double> kept) const {
  force->powers(in(powers));
  if (force->later_powers() == LaterPowers::in_next_evaluation) force->kept_powers(in(kept));
}

template <class Space>
void LeapfrogWork<Space>::take_powers() {
  for (const Worker& worker : workers_) worker.ask(powers_, kept_);
}

template <class Space>
void LeapfrogWork<Space>::take_step(const State<Space>& state, double dt) {
  for (const Worker& worker : workers_) {
    const std::span<double> works = worker.in(works_), powers = worker.in(powers_),
                            kept = worker.in(kept_), later = worker.in(later_);
    switch (worker.force->later_powers()) {
      case LaterPowers::at_once:
        worker.force->powers_with(state, later);
        for (std::size_t w = 0; w < works.size(); ++w)
          works[w] += 0.5 * (last_dt_ * powers[w] + dt * later[w]);
        break;
      case LaterPowers::in_next_evaluation:
        for (std::size_t w = 0; w < works.size(); ++w)
          works[w] += 0.5 * last_dt_ * (kept[w] + powers[w]);
        break;
      case LaterPowers::never:
        for (std::size_t w = 0; w < works.size(); ++w)
          works[w] += (last_dt_ > 0 ? dt : 0.25 * dt) * powers[w];
        break;
    }
  }
  last_dt_ = dt;
}

template <class Space>
std::vector<double> LeapfrogWork<Space>::works() const {
  std::vector<double> until_now(works_.begin(), works_.end()), all_powers(works_.size()),
      all_kept(works_.size());
  for (const Worker& worker : workers_) {
    worker.ask(all_powers, all_kept);
    const std::span<double> now = worker.in(until_now), powers = worker.in(all_powers),
                            kept = worker.in(all_kept);
    switch (worker.force->later_powers()) {
      case LaterPowers::at_once:
        for (std::size_t w = 0; w < now.size(); ++w) now[w] += 0.5 * (last_dt_ * powers[w]);
        break;
      case LaterPowers::in_next_evaluation:
        for (std::size_t w = 0; w < now.size(); ++w)
          now[w] += 0.5 * last_dt_ * (kept[w] + powers[w]);
        break;
      case LaterPowers::never:
        for (std::size_t w = 0; w < now.size(); ++w) now[w] += 0.75 * last_dt_ * powers[w];
        break;
    }
  }
  return until_now;
}

template class LeapfrogWork<Spatial>;
template class LeapfrogWork<Planar>;

}  // namespace floe
