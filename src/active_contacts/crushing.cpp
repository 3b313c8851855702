#include "active_contacts/crushing.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "floe/base/item.h"

namespace floe {

std::array<double, Crush::numbers> Crush::as_numbers() const {
  return {static_cast<double>(a),
          static_cast<double>(b),
          normal_a.x,
          normal_a.y,
          normal_a.z,
          normal_b.x,
          normal_b.y,
          normal_b.z,
          before,
          plastic};
}

Crush Crush::from(std::span<const double, numbers> n) {
  return {.a = static_cast<std::int32_t>(n[0]),
          .b = static_cast<std::int32_t>(n[1]),
          .normal_a = {n[2], n[3], n[4]},
          .normal_b = {n[5], n[6], n[7]},
          .before = n[8],
          .plastic = n[9]};
}

void Crushing::start() {
  std::swap(records_, last_);
  records_.clear();
  parted_.clear();
  next_ = 0;
}

void Crushing::move(const Pair& from, const Pair& to) {
  const auto is = [](const Pair& pair) {
    return [&](const Crush& crush) { return crush.a == pair.a && crush.b == pair.b; };
  };
  const auto moved = std::find_if(records_.begin(), records_.end(), is(from));
  if (moved == records_.end()) return;
  Crush crush = *moved;
  records_.erase(moved);
  const auto there = std::find_if(records_.begin(), records_.end(), is(to));
  if (there != records_.end()) {
    there->before += crush.before;
    there->plastic += crush.plastic;
    return;
  }
  crush.b = to.b;
  const auto after = [&](const Crush& c) {
    return std::tie(c.a, c.b) > std::tie(crush.a, crush.b);
  };
  records_.insert(std::find_if(records_.begin(), records_.end(), after), crush);
}

void Crushing::take(const Pair& pair, double before, double after, const Vec3<double>& normal,
                    const Triad<double>& axes_a, const Triad<double>& axes_b) {
  const auto key = [](const auto& of) { return std::tie(of.a, of.b); };
  while (next_ < last_.size() && key(last_[next_]) < key(pair)) parted_.push_back(last_[next_++]);
  const bool known = next_ < last_.size() && key(last_[next_]) == key(pair);
  if (!known && !(after > before)) return;
  Crush crush = known ? last_[next_++] : Crush{.a = pair.a, .b = pair.b, .before = before};
  if (after > before) {
    crush.plastic = after;
    crush.normal_a = axes_a.to_local(normal);
    crush.normal_b = axes_b.to_local(normal);
  }
  records_.push_back(crush);
}

void Crushing::end() {
  while (next_ < last_.size()) parted_.push_back(last_[next_++]);
}

std::vector<double> Crushing::rows() const {
  std::vector<double> rows;
  for (const Crush& crush : records_) {
    const auto numbers = crush.as_numbers();
    rows.insert(rows.end(), numbers.begin(), numbers.end());
  }
  return rows;
}

void Crushing::restore(std::span<const double> rows, std::span<const std::uint8_t> here) {
  records_.clear();
  for (std::size_t k = 0; k + Crush::numbers <= rows.size(); k += Crush::numbers) {
    const Crush crush = Crush::from(rows.subspan(k).first<Crush::numbers>());
    if (item(here, crush.a) != 0) records_.push_back(crush);
  }
}

}  // namespace floe
