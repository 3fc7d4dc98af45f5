#pragma once

#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace kino {

/// What the world broke: a device, a file, a user's scene. Programmer errors use KINO_CHECK.
struct Error {
    std::string what;   ///< what went wrong, one sentence without a full stop
    std::string where;  ///< file, URI, device or JSON pointer it happened at; may be empty
    std::string hint;   ///< what the user can do about it; may be empty

    /// "where: what (hint)", for a person.
    [[nodiscard]] std::string to_string() const;
};

template <class T>
using Result = tl::expected<T, Error>;

[[nodiscard]] inline tl::unexpected<Error> fail(std::string what, std::string where = {},
                                                std::string hint = {}) {
    return tl::unexpected<Error>(Error{std::move(what), std::move(where), std::move(hint)});
}

/// Passes an inner error on, naming the outer place if the inner one named none.
[[nodiscard]] tl::unexpected<Error> fail(Error inner, const std::string& where_if_empty = {});

}  // namespace kino

/// Evaluates a Result; on error returns it from the enclosing function, else yields nothing.
#define KINO_TRY(expression)                                                          \
    do {                                                                              \
        if (auto kino_try_result = (expression); !kino_try_result) {                  \
            return tl::unexpected<::kino::Error>(std::move(kino_try_result).error()); \
        }                                                                             \
    } while (false)

#define KINO_CONCAT_INNER(a, b) a##b
#define KINO_CONCAT(a, b) KINO_CONCAT_INNER(a, b)

/// KINO_ASSIGN(auto frame, read_frame(path)): declares `frame`, or returns the error.
#define KINO_ASSIGN(declaration, expression)                         \
    auto KINO_CONCAT(kino_result_, __LINE__) = (expression);         \
    if (!KINO_CONCAT(kino_result_, __LINE__)) {                      \
        return tl::unexpected<::kino::Error>(                        \
            std::move(KINO_CONCAT(kino_result_, __LINE__)).error()); \
    }                                                                \
    declaration = std::move(*KINO_CONCAT(kino_result_, __LINE__))
