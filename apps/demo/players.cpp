#include "apps/demo/players.h"

#include <algorithm>

namespace kino::demo {

Player* Players::free_place() {
    for (Player& player : all_) {
        if (player.id == 0) return &player;
    }
    // Somebody who was not seen lately makes room for who is there.
    const auto away = std::max_element(
        all_.begin(), all_.end(), [](const auto& a, const auto& b) { return a.away_s < b.away_s; });
    return away->away_s > 0.5 ? &*away : nullptr;
}

Players::Change Players::engage(std::uint32_t id) {
    if (id == 0) return Change::none;
    const int known = place_of(id);
    if (known >= 0 && all_[static_cast<std::size_t>(known)].primary) return Change::none;
    Player* place = known >= 0 ? &all_[static_cast<std::size_t>(known)] : free_place();
    // The recogniser has the last word: the second one gives way.
    for (Player& player : all_) {
        if (place == nullptr && !player.primary) place = &player;
    }
    if (place == nullptr) place = &all_[0];
    for (Player& player : all_) player.primary = false;
    const bool is_new = known < 0;
    if (is_new) *place = {.id = id};
    place->primary = true;
    return is_new ? Change::joined : Change::took_over;
}

Players::Change Players::join(std::uint32_t id) {
    if (id == 0 || place_of(id) >= 0) return Change::none;
    Player* place = free_place();
    if (place == nullptr) return Change::full;
    *place = {.id = id};
    return Change::joined;
}

bool Players::release(std::uint32_t id, bool still_there) {
    const int place = place_of(id);
    if (place < 0) return false;
    Player& player = all_[static_cast<std::size_t>(place)];
    player.primary = false;
    if (!still_there) player = {};
    return true;
}

std::vector<std::uint32_t> Players::step(double dt_s, std::span<const CastMember> cast) {
    std::vector<std::uint32_t> left;
    for (Player& player : all_) {
        if (player.id == 0) continue;
        const bool here = std::any_of(cast.begin(), cast.end(), [&](const CastMember& member) {
            return member.id == player.id && member.present;
        });
        player.away_s = here ? 0 : player.away_s + dt_s;
        if (player.away_s <= kAwayS) continue;
        left.push_back(player.id);
        player = {};
    }
    return left;
}

const Player* Players::primary() const {
    for (const Player& player : all_) {
        if (player.id != 0 && player.primary) return &player;
    }
    return nullptr;
}

int Players::place_of(std::uint32_t id) const {
    for (std::size_t i = 0; i < all_.size(); ++i) {
        if (id != 0 && all_[i].id == id) return static_cast<int>(i);
    }
    return -1;
}

bool Players::anybody() const {
    return std::any_of(all_.begin(), all_.end(), [](const Player& p) { return p.id != 0; });
}

}  // namespace kino::demo
