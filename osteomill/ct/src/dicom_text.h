#pragma once

#include <string>

class DcmItem;
class DcmTagKey;

namespace osteomill {

/// Returns the text of an element for people to read: in UTF-8, out of the character sets that `data` names
/// (else UTF-8 or, if it is none, Latin 1), with a question mark for every control character. Empty if there
/// is no such element.
std::string shown_text(DcmItem& data, const DcmTagKey& tag);

}  // namespace osteomill
