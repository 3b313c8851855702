/// \file
/// The register of contact laws.
///
/// A law is a type with the members that IsContactLaw asks for. A new law is one header in this
/// folder and its type in the list ContactLaws. The loop over pairs is compiled for each type of
/// the list, and an evaluation chooses among them once. A scene names a law by its `word`, an
/// enumerator of ContactLaw (docs/howto.md, "A contact law").
#pragma once

#include <concepts>
#include <cstddef>
#include <stdexcept>
#include <type_traits>
#include <variant>

#include "contact_laws/overlap.h"
#include "contact_laws/potential.h"
#include "contact_laws/trial.h"

namespace floe {

using ContactLaws = std::variant<OverlapLaw, PotentialLaw>;

/// What a law must have:
/// - `word`, by which a scene names it;
/// - a constructor from the options, from which the law takes its constants;
/// - `constants`, of the terms that laws share;
/// - `term`, the elastic force of a contact with a direction, or of one in each lane;
/// - `stored`, the energy that this force stores;
/// - `steepness`, for the bound of the stable step: the largest factor by which the elastic force
///   rises with the overlap faster than k_v |S|, from the area of the largest face of a body and
///   from its A_r [m^2].
template <class Law>
concept IsContactLaw = std::constructible_from<Law, const ContactOptions&> &&
    requires(const Law& law, const ContactState& state, const ContactStateOf<Lanes>& states,
             const ContactTrial& trial) {
  { Law::word } -> std::convertible_to<ContactLaw>;
  { law.constants } -> std::convertible_to<SharedConstants>;
  { law.term(state) } -> std::same_as<ElasticTerm>;
  { law.term(states) } -> std::same_as<ElasticTermOf<Lanes>>;
  { law.stored(trial) } -> std::same_as<double>;
  { law.steepness(0.0, 0.0) } -> std::same_as<double>;
};

/// Returns the law that the options name, with its constants.
template <std::size_t first = 0>
ContactLaws law_of(const ContactOptions& options) {
  using Law = std::variant_alternative_t<first, ContactLaws>;
  static_assert(IsContactLaw<Law>);
  if (options.law == Law::word) return Law(options);
  if constexpr (first + 1 < std::variant_size_v<ContactLaws>) return law_of<first + 1>(options);
  throw std::logic_error("a contact law is not in the list ContactLaws");
}

/// Returns the energy that a contact stores.
/// \param springs  of friction, within their limit
template <IsContactLaw Law>
StoredEnergy stored_energy(const Law& law, const ContactTrial& trial, const Friction& springs) {
  if (trial.area == 0) return {};
  const PairHistory now = history_of(trial, springs);
  return {.normal = law.stored(trial), .tangential = now.springs.energy() + now.twist.energy()};
}

}  // namespace floe
