#include "contact_force/checks.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/collectives.h"
#include "base/format.h"
#include "floe/base/petsc.h"

namespace floe {
namespace {

std::string name_of(const Contacts& contacts, std::int32_t body) {
  if (body >= 0) return "body " + std::to_string(body);
  return "obstacle '" + contacts.obstacles()[static_cast<std::size_t>(-1 - body)].name + "'";
}

}  // namespace

void refuse_enclosed(const Contacts& contacts, MPI_Comm comm) {
  std::vector<std::int32_t> mine;
  for (const auto& pair : contacts.enclosed()) mine.insert(mine.end(), pair.begin(), pair.end());
  const std::vector<std::int32_t> all = all_gathered(mine, comm);
  if (all.empty()) return;
  std::array<std::int32_t, 2> first{all[0], all[1]};  // the first pair, independent of the ranks
  for (std::size_t k = 2; k < all.size(); k += 2) first = std::min(first, {all[k], all[k + 1]});
  const std::string body = "body " + std::to_string(first[0]);
  if (first[1] >= 0)
    throw InputError("forces: contact: " + body + " and body " + std::to_string(first[1]) +
                     ": one lies wholly inside the other, they would feel nothing");
  const Obstacle& o = contacts.obstacles()[static_cast<std::size_t>(-1 - first[1])];
  throw InputError("obstacle: " + o.name + ": " + body +
                   " lies wholly inside it: obstacles are solid, it would feel nothing");
}

std::string check_overlaps(const Contacts& contacts, MPI_Comm comm) {
  constexpr double slight = 1e-3, deep = 0.1;  // of the smaller size
  std::vector<double> mine;
  for (const Contacts::Penetration& p : contacts.penetrations()) {
    if (p.share > slight)
      mine.insert(mine.end(),
                  {p.share, p.depth, static_cast<double>(p.a), static_cast<double>(p.b)});
  }
  const std::vector<double> all = all_gathered(mine, comm);
  if (all.empty()) return {};
  std::array<double, 4> worst{};
  for (std::size_t k = 0; k < all.size(); k += 4) {
    const std::array row{all[k], all[k + 1], all[k + 2], all[k + 3]};
    // Of equal shares the first pair is taken, independent of the ranks.
    if (row[0] > worst[0] ||
        (row[0] == worst[0] &&
         std::lexicographical_compare(row.begin() + 2, row.end(), worst.begin() + 2, worst.end())))
      worst = row;
  }
  const auto& [share, depth, a, b] = worst;
  const std::string pair = "body " + text(a) + " and " +
                           name_of(contacts, static_cast<std::int32_t>(b)) + " overlap by " +
                           text(depth) + " m at the start, " + text(share) +
                           " of the smaller one's size";
  const bool pressing = contacts.options().initial_overlap == InitialOverlap::press;
  if (pressing && share > deep)
    throw InputError("forces: contact: " + pair + " (at most " + text(deep) +
                     "): they would burst apart; move one of them, or let "
                     "'contact: initial_overlap: stress_free' take what overlaps as rest");
  const std::size_t pairs = all.size() / 4;
  return "contact: " + pair + (pressing ? "; overlaps press apart" : "; overlaps count as rest") +
         " (pairs with more than " + text(slight) + ": " + std::to_string(pairs) + ")";
}

LimitsStep<Spatial>::Limit travel_limit(const Contacts& contacts, const Part& part,
                                        const State<Spatial>& state) {
  constexpr double share = 0.1;
  const auto length = [](const double* v) {
    return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  };
  double body_speed = 0, obstacle_speed = 0;
  std::int32_t fastest = 0;
  for (std::int32_t b = 0; b < part.owned; ++b) {
    const auto k = static_cast<std::size_t>(b);
    const double speed =
        length(state.record(k) + Spatial::velocity) +
        contacts.radius(part.global[k]) * length(state.record(k) + Spatial::angular_velocity);
    if (!(speed > body_speed)) continue;
    body_speed = speed;
    fastest = part.global[k];
  }
  std::string obstacle;
  for (std::size_t k = 0; k < contacts.obstacles().size(); ++k) {
    const Obstacle& o = contacts.obstacles()[k];
    const double speed = o.motion.largest_speed(contacts.obstacle_radius(k));
    if (!(speed > obstacle_speed)) continue;
    obstacle_speed = speed;
    obstacle = o.name;
  }
  const double approach = body_speed + std::max(body_speed, obstacle_speed);
  if (!(approach > 0)) return {};
  return {share * contacts.thinnest() / approach,
          "speed of " +
              (obstacle_speed > body_speed ? "obstacle '" + obstacle + "'"
                                           : "body " + std::to_string(fastest)) +
              ": bodies may come nearer by a tenth of the least width of all, " +
              text(contacts.thinnest()) + " m, in a step"};
}

std::vector<Remark> ContactRemarks::take(const Contacts& contacts) {
  std::vector<Remark> remarks;
  const auto tell = [&](const Contacts::Event& event, bool& told, const std::string& what,
                        const std::string& why) {
    if (told || !event.happened) return;
    told = true;
    remarks.push_back({event.time, "contact: from " + text(event.time) + " s on body " +
                                       std::to_string(event.a) + what + name_of(contacts, event.b) +
                                       ": " + why});
  };
  tell(contacts.first_enclosed(), told_enclosed_, " and ",
       "one lies inside the other or reaches through it, and they press on each other nowhere "
       "(history.csv: contacts_enclosed counts such pairs)");
  tell(contacts.first_pressed_through(), told_pressed_through_, " is pressed into ",
       "by more than a quarter of the thinner one's width, so that it may pass through "
       "('contact: young' is too small for this speed or load)");
  return remarks;
}

}  // namespace floe
