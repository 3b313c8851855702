#include "contact_force/checks.h"

#include <algorithm>
#include <span>
#include <tuple>

#include "base/collectives.h"
#include "base/format.h"
#include "floe/base/petsc.h"

namespace floe {
namespace {

std::string name_of(const Solids& solids, std::int32_t index) {
  if (solids.is_ice(index)) return "body " + std::to_string(solids.body_of(index));
  return "obstacle '" + solids.obstacle(index).name + "'";
}

/// The numbers of a penetration that ranks exchange.
struct PenetrationRow {
  double share = 0, depth = 0, a = 0, b = 0;
};

/// Returns the largest share of several penetrations; of equal shares that of the first pair,
/// independent of the ranks.
PenetrationRow worst_of(std::span<const double> rows) {
  PenetrationRow worst;
  for (std::size_t k = 0; k < rows.size(); k += 4) {
    const PenetrationRow row{
        .share = rows[k], .depth = rows[k + 1], .a = rows[k + 2], .b = rows[k + 3]};
    if (row.share > worst.share ||
        (row.share == worst.share && std::tie(row.a, row.b) < std::tie(worst.a, worst.b)))
      worst = row;
  }
  return worst;
}

}  // namespace

void refuse_enclosed(const Contacts& contacts, MPI_Comm comm) {
  std::vector<std::int32_t> mine;
  for (const BodyPair& pair : contacts.enclosed())
    mine.insert(mine.end(), pair.begin(), pair.end());
  const std::vector<std::int32_t> all = all_gathered(mine, comm);
  if (all.empty()) return;
  BodyPair first{all[0], all[1]};  // the first pair, independent of the ranks
  for (std::size_t k = 2; k < all.size(); k += 2) first = std::min(first, {all[k], all[k + 1]});
  const std::string body = name_of(contacts.solids(), first[0]);
  if (contacts.solids().is_ice(first[1]))
    throw InputError("forces: contact: " + body + " and " + name_of(contacts.solids(), first[1]) +
                     ": one lies wholly inside the other, they would feel nothing");
  throw InputError("obstacle: " + contacts.solids().obstacle(first[1]).name + ": " + body +
                   " lies wholly inside it: obstacles are solid, it would feel nothing");
}

std::string check_overlaps(const Contacts& contacts, MPI_Comm comm) {
  constexpr double slight = 1e-3, deep = 0.1;  // of the smaller size
  std::vector<double> mine;
  for (const Penetration& p : contacts.penetrations()) {
    if (p.share > slight)
      mine.insert(mine.end(),
                  {p.share, p.depth, static_cast<double>(p.a), static_cast<double>(p.b)});
  }
  const std::vector<double> all = all_gathered(mine, comm);
  if (all.empty()) return {};
  const PenetrationRow worst = worst_of(all);
  const std::string pair =
      name_of(contacts.solids(), static_cast<std::int32_t>(worst.a)) + " and " +
      name_of(contacts.solids(), static_cast<std::int32_t>(worst.b)) + " overlap by " +
      text(worst.depth) + " m at the start, " + text(worst.share) + " of the smaller one's size";
  const bool pressing = contacts.options().initial_overlap == InitialOverlap::press;
  if (pressing && worst.share > deep)
    throw InputError("forces: contact: " + pair + " (at most " + text(deep) +
                     "): they would burst apart; move one of them, or let "
                     "'contact: initial_overlap: stress_free' take what overlaps as rest" +
                     (worst.a < 0 && !contacts.solids().is_ice(static_cast<std::int32_t>(worst.a))
                          ? ", or let a structure touch nothing but ice ('touches: ice')"
                          : ""));
  const std::size_t pairs = all.size() / 4;
  return "contact: " + pair + (pressing ? "; overlaps press apart" : "; overlaps count as rest") +
         " (pairs with more than " + text(slight) + ": " + std::to_string(pairs) + ")";
}

LimitsStep<Spatial>::Limit travel_limit(const Solids& solids, const Part& part,
                                        const State<Spatial>& state) {
  constexpr double share = 0.1;
  double body_speed = 0, obstacle_speed = 0;
  std::int32_t fastest = 0;
  for (std::int32_t b = 0; b < part.owned; ++b) {
    const auto k = static_cast<std::size_t>(b);
    const double speed = length(velocity(state, k)) +
                         solids.radius(part.global[k]) * length(angular_velocity(state, k));
    if (!(speed > body_speed)) continue;
    body_speed = speed;
    fastest = part.global[k];
  }
  std::string obstacle;
  for (std::size_t k = 0; k < solids.obstacles().size(); ++k) {
    const Obstacle& o = solids.obstacles()[k];
    const double speed = o.motion.largest_speed(solids.radius(part_index(solids.parts_of(k)[0])));
    if (!(speed > obstacle_speed)) continue;
    obstacle_speed = speed;
    obstacle = o.name;
  }
  const double approach = body_speed + std::max(body_speed, obstacle_speed);
  if (!(approach > 0)) return {};
  return {share * solids.thinnest() / approach,
          "speed of " +
              (obstacle_speed > body_speed ? "obstacle '" + obstacle + "'"
                                           : "body " + std::to_string(fastest)) +
              ": bodies may come nearer by a tenth of the least width of all, " +
              text(solids.thinnest()) + " m, in a step"};
}

void ContactRemarks::persist(Archive& archive, MPI_Comm comm) {
  told_enclosed_ = on_any_rank(told_enclosed_, comm);
  told_pressed_through_ = on_any_rank(told_pressed_through_, comm);
  archive.common("told_enclosed", told_enclosed_);
  archive.common("told_pressed_through", told_pressed_through_);
}

std::vector<Remark> ContactRemarks::take(const Contacts& contacts) {
  std::vector<Remark> remarks;
  const auto tell = [&](const ContactEvent& event, bool& told, const std::string& what,
                        const std::string& why) {
    if (told || !event.happened) return;
    told = true;
    remarks.push_back({event.time, "contact: from " + text(event.time) + " s on " +
                                       name_of(contacts.solids(), event.a) + what +
                                       name_of(contacts.solids(), event.b) + ": " + why});
  };
  tell(contacts.events().first_enclosed(), told_enclosed_, " and ",
       "one lies inside the other or reaches through it, and they press on each other nowhere "
       "(history.csv: contacts_enclosed counts such pairs)");
  tell(contacts.events().first_pressed_through(), told_pressed_through_, " is pressed into ",
       "by more than a quarter of the thinner one's width, so that it may pass through "
       "('contact: young' is too small for this speed or load)");
  return remarks;
}

}  // namespace floe
