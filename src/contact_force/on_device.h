/// \file
/// Contacts in the form in which back ends take them.
#pragma once

#include <string>
#include <vector>

#include "active_contacts/contacts.h"
#include "forces/device_contacts.h"
#include "lattice/partition.h"

namespace floe {

/// Returns what contacts have that back ends do not have yet, as messages name it; empty: nothing.
std::string missing_on_devices(const Contacts& contacts);

/// Returns the shapes and the law of contacts that back ends have.
/// \param contacts  must outlive what is returned
DeviceContacts on_device(const Contacts& contacts, const Part& part);

/// Returns the pairs of the list, with their histories.
DevicePairs pairs_on_device(const Contacts& contacts, const Part& part);

/// Returns the crushes of the pairs that have crushed, or of those that have parted. A and B are
/// bodies of the model.
std::vector<Crush> crushes(const DevicePairs& pairs, const Part& part);
std::vector<Crush> crushes(std::span<const PartedPair> pairs, const Part& part);

/// Returns all planes beyond which bodies have nothing left.
/// \param bodies  of the model
std::vector<WornPlane> worn_on_device(const Contacts& contacts, const Part& part,
                                      std::span<const std::int32_t> bodies);

/// Returns the rows of ContactHistory for pairs that touch.
std::vector<double> history_rows(const DevicePairs& pairs, const Part& part);

}  // namespace floe
