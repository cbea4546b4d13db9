#pragma once

#include <string>

class DcmItem;
class DcmTagKey;

namespace osteomill {

/// Returns the text of an element for display, converted to UTF-8 from the character sets that `data` names
/// (if none: UTF-8 or, if invalid, Latin 1). Replaces control characters by question marks. Empty if the
/// element is missing.
std::string display_text(DcmItem& data, const DcmTagKey& tag);

}  // namespace osteomill
