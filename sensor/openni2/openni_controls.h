#pragma once

#include <memory>

#include "sensor/openni2/openni_session.h"

namespace kino {

/// Automatic exposure and white balance, exposure and gain of the colour camera, as far as the
/// driver has them. OpenNI2 does not state ranges: a value that the driver refuses is an error.
class OpenniControls final : public Controls {
  public:
    explicit OpenniControls(std::shared_ptr<OpenniSession> session);

    [[nodiscard]] std::vector<Control> list() const override { return controls_; }
    [[nodiscard]] Result<double> get(const std::string& id) override;
    Result<void> set(const std::string& id, double value) override;

  private:
    [[nodiscard]] Result<std::size_t> index_of(const std::string& id) const;

    std::shared_ptr<OpenniSession> session_;
    std::vector<Control> controls_;
    std::vector<int> properties_;  ///< openni::kStream..., one a control
};

}  // namespace kino
