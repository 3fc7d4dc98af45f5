#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace kino {

/// A value inside a JSON document and the way to it: every complaint names its JSON pointer.
class JsonCursor {
  public:
    JsonCursor(const nlohmann::json& value, std::string where, std::string pointer = {})
        : value_(&value), where_(std::move(where)), pointer_(std::move(pointer)) {}

    /// Fails unless this is an object; an unknown key is an error that lists the known ones.
    [[nodiscard]] Result<void> only(std::initializer_list<std::string_view> keys) const;
    [[nodiscard]] Result<JsonCursor> member(const char* key) const;
    [[nodiscard]] std::optional<JsonCursor> find(const char* key) const;
    [[nodiscard]] Result<std::vector<JsonCursor>> items(std::size_t least, std::size_t most) const;

    [[nodiscard]] Result<double> number() const;
    [[nodiscard]] Result<std::int64_t> integer(std::int64_t least, std::int64_t most) const;
    [[nodiscard]] Result<std::string> text() const;
    [[nodiscard]] Result<bool> boolean() const;

    /// Overwrite `out` where the key is there; leave it where it is not.
    [[nodiscard]] Result<void> read(const char* key, double& out) const;
    [[nodiscard]] Result<void> read(const char* key, std::string& out) const;
    [[nodiscard]] Result<void> read(const char* key, bool& out) const;

    [[nodiscard]] tl::unexpected<Error> error(std::string what, std::string hint = {}) const;

  private:
    const nlohmann::json* value_;
    std::string where_;
    std::string pointer_;
};

/// Fails on anything that is not one JSON value, numbers beyond double's range included.
[[nodiscard]] Result<nlohmann::json> parse_json(std::string_view text, const std::string& where);

}  // namespace kino
