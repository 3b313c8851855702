/// \file
/// The manual page.
#pragma once

#include <string>

namespace floe::program {

/// Returns floe.1 in the language of man pages (groff_man(7)), with all options of the table.
std::string manual_page();

}  // namespace floe::program
