#include "skeleton/gestures/template_json.h"

#include <utility>

namespace kino {

Result<GestureTemplate> template_from_json(const JsonCursor& object) {
    KINO_TRY(object.only({"name", "hand", "least_s", "most_s", "threshold", "examples"}));
    KINO_ASSIGN(const JsonCursor name_at, object.member("name"));
    KINO_ASSIGN(std::string name, name_at.text());
    KINO_ASSIGN(const JsonCursor hand_at, object.member("hand"));
    KINO_ASSIGN(const std::string hand_text, hand_at.text());
    Hand hand = Hand::none;
    for (const Hand h : {Hand::left, Hand::right, Hand::both})
        if (hand_name(h) == hand_text) hand = h;
    if (hand == Hand::none) return hand_at.error("must be left, right or both");
    double number[3] = {};
    const char* const keys[3] = {"least_s", "most_s", "threshold"};
    for (std::size_t i = 0; i < 3; ++i) {
        KINO_ASSIGN(const JsonCursor at, object.member(keys[i]));
        KINO_ASSIGN(number[i], at.number());
    }
    KINO_ASSIGN(const JsonCursor list_at, object.member("examples"));
    KINO_ASSIGN(const auto list, list_at.items(1, GestureTemplate::kMaxExamples));
    std::vector<GestureTemplate::Example> examples;
    for (const JsonCursor& example_at : list) {
        KINO_ASSIGN(const auto rows,
                    example_at.items(GestureTemplate::kSamples, GestureTemplate::kSamples));
        GestureTemplate::Example& example = examples.emplace_back();
        for (const JsonCursor& row : rows) {
            KINO_ASSIGN(const auto cells, row.items(6, 6));
            auto& hands = example.emplace_back();
            for (std::size_t i = 0; i < 6; ++i) {
                KINO_ASSIGN(hands[i / 3][static_cast<int>(i % 3)], cells[i].number());
            }
        }
    }
    auto made = GestureTemplate::restore(std::move(name), hand, number[0], number[1], number[2],
                                         std::move(examples));
    if (!made) return object.error(made.error().what, made.error().hint);
    return made;
}

nlohmann::ordered_json template_to_json(const GestureTemplate& gesture) {
    nlohmann::ordered_json out = {{"name", gesture.name()},
                                  {"hand", hand_name(gesture.hand())},
                                  {"least_s", gesture.least_s()},
                                  {"most_s", gesture.most_s()},
                                  {"threshold", gesture.threshold()}};
    out["examples"] = nlohmann::ordered_json::array();
    for (const auto& example : gesture.examples()) {
        auto rows = nlohmann::ordered_json::array();
        for (const auto& [left, right] : example)
            rows.push_back({left.x, left.y, left.z, right.x, right.y, right.z});
        out["examples"].push_back(std::move(rows));
    }
    return out;
}

}  // namespace kino
