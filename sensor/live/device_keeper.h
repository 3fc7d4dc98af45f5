#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "sensor/live/device.h"
#include "sensor/live/live_source.h"

namespace kino {

/// What a DeviceKeeper tells. put() comes from the device's threads, the rest from the keeper's;
/// device_went() from either.
class KeeperClient {
  public:
    virtual ~KeeperClient() = default;
    virtual void device_opened(const SourceInfo& first) = 0;  ///< once, before all else
    virtual void put(StreamId id, StreamFrame frame) = 0;
    /// Before the first and after the last frame of the stream.
    virtual void stream_turned(StreamId id, bool on) = 0;
    virtual void device_came() = 0;   ///< the unit is open again; streams are about to start
    virtual void device_works() = 0;  ///< all subscribed streams run
    /// Nothing is put until device_came(). Also where one that came never got to work.
    virtual void device_went(const std::string& why) = 0;
};

/// Owns the LiveDevice on a thread of its own, looks for the unit when it has gone, and puts
/// everything back. All calls from any thread; each waits for the keeper's thread.
class DeviceKeeper {
  public:
    /// `client` outlives the keeper.
    [[nodiscard]] static Result<std::unique_ptr<DeviceKeeper>> open(DeviceDriver driver,
                                                                    const std::string& address,
                                                                    const LiveOptions& options,
                                                                    KeeperClient& client);
    ~DeviceKeeper();
    DeviceKeeper(const DeviceKeeper&) = delete;
    DeviceKeeper& operator=(const DeviceKeeper&) = delete;

    [[nodiscard]] bool has_controls() const { return has_controls_; }
    /// As known last where the device is away or busy.
    [[nodiscard]] Result<RigParameters> calibration();

    /// Turning on fails where the device refuses; one that is away or goes meanwhile does not.
    Result<void> turn(StreamId id, bool on);

    [[nodiscard]] std::vector<Control> control_list() const;
    [[nodiscard]] Result<double> get_control(const std::string& id);
    Result<void> set_control(const std::string& id, double value);

    [[nodiscard]] LiveStats stats() const;  ///< without frames and overtaken

  private:
    class Intake;
    struct Order {
        std::function<void()> run;
        bool done = false;
        bool called_off = false;
    };

    DeviceKeeper(DeviceDriver driver, const LiveOptions& options, KeeperClient& client);
    void run(const std::string& address);
    [[nodiscard]] Result<void> open_first(const std::string& address);
    void keep();
    void read_properties();
    void let_go();
    void look_for_it();
    void postpone_look(TimeNs now);
    void wait_for_news(TimeNs until);
    [[nodiscard]] Result<void> take_up_again();
    [[nodiscard]] Result<void> start_afresh(StreamId id);
    void wake();
    [[nodiscard]] bool gone() const;

    /// Runs on the keeper's thread; false if it could not begin within `timeout` (none: for ever)
    /// or was not done by then.
    bool order(std::function<void()> work, std::optional<TimeNs> timeout);
    Result<double> control_call(const std::string& id,
                                std::function<Result<double>(Controls&)> call);

    const DeviceDriver driver_;
    const LiveOptions options_;
    KeeperClient& client_;

    // Fixed once open.
    SourceInfo info_;
    std::string address_;
    bool has_controls_ = false;

    // The keeper thread's own.
    std::unique_ptr<Intake> intake_;  ///< outlives device_
    std::unique_ptr<LiveDevice> device_;
    std::vector<StreamId> subscribed_;
    std::vector<std::pair<std::string, double>> settings_;  ///< last set comes last
    TimeNs next_look_ = 0;
    TimeNs look_distance_ = 0;
    TimeNs present_since_ = 0;

    mutable std::mutex mutex_;
    std::condition_variable work_;
    std::condition_variable answered_;
    std::deque<std::shared_ptr<Order>> orders_;
    std::shared_ptr<HotplugWatch> watch_;  ///< while the device is away
    Result<RigParameters> calibration_ = RigParameters{};
    std::vector<Control> controls_;
    LiveStats stats_;
    std::optional<Result<void>> opened_;
    bool gone_ = false;
    bool stopping_ = false;

    std::thread thread_;
};

}  // namespace kino
