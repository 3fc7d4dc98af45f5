#include <utility>

#include "sensor/live/composite_parts.h"

namespace kino {
namespace {

constexpr const char* kPrefix = "color.";

class MergedControls final : public Controls {
  public:
    MergedControls(Controls* first, Controls* second) : first_(first), second_(second) {}

    std::vector<Control> list() const override {
        std::vector<Control> all = first_ ? first_->list() : std::vector<Control>();
        if (!second_) return all;
        for (Control& control : second_->list()) {
            if (first_has(control.id)) {
                control.id = kPrefix + control.id;
                control.name = "colour " + control.name;
            }
            all.push_back(std::move(control));
        }
        return all;
    }

    Result<double> get(const std::string& id) override {
        const auto [controls, own_id] = find(id);
        if (!controls) return fail("no such control", id);
        return controls->get(own_id);
    }
    Result<void> set(const std::string& id, double value) override {
        const auto [controls, own_id] = find(id);
        if (!controls) return fail("no such control", id);
        return controls->set(own_id, value);
    }

  private:
    bool first_has(const std::string& id) const {
        if (!first_) return false;
        for (const Control& control : first_->list()) {
            if (control.id == id) return true;
        }
        return false;
    }
    std::pair<Controls*, std::string> find(const std::string& id) const {
        if (first_has(id)) return {first_, id};
        const std::string prefix = kPrefix;
        if (!id.starts_with(prefix)) return {second_, id};
        const std::string own = id.substr(prefix.size());
        return {second_, first_has(own) ? own : id};
    }

    Controls* first_;
    Controls* second_;
};

}  // namespace

std::unique_ptr<Controls> merge_controls(Controls* first, Controls* second) {
    if (!first && !second) return nullptr;
    return std::make_unique<MergedControls>(first, second);
}

}  // namespace kino
