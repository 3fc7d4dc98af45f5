#include "base/error.h"

namespace kino {

std::string Error::to_string() const {
    std::string text;
    if (!where.empty()) text += where + ": ";
    text += what;
    if (!hint.empty()) text += " (" + hint + ")";
    return text;
}

tl::unexpected<Error> fail(Error inner, const std::string& where_if_empty) {
    if (inner.where.empty()) inner.where = where_if_empty;
    return tl::unexpected<Error>(std::move(inner));
}

}  // namespace kino
