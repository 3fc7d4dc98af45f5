#include "sensor/kinect1/libusb_stream.h"

#include <fmt/format.h>

#include <condition_variable>
#include <mutex>
#include <vector>

namespace kino::usb {
namespace {

// A transfer that fails is sent again; this many failures in a row are the end of the stream.
constexpr int kMaxFailures = 64;
constexpr std::chrono::seconds kStopPatience{1};

struct StreamState {
    std::mutex mutex;
    std::condition_variable retired;
    PacketSink* sink = nullptr;
    IsoParameters parameters;
    std::vector<std::uint8_t> buffer;
    std::vector<libusb_transfer*> transfers;
    std::vector<Packet> batch;
    int pending = 0;
    int failures = 0;
    bool ending = false;  // no transfer is sent again
    /// Set if the system keeps transfers for good: it may still write to the buffer.
    std::shared_ptr<StreamState> kept_alive;

    ~StreamState() {
        for (libusb_transfer* transfer : transfers) libusb_free_transfer(transfer);
    }

    void end(Failure kind, const char* what) {
        if (ending) return;
        ending = true;
        if (sink) sink->ended({kind, what});
    }

    void hand_on(const libusb_transfer* transfer) {
        batch.clear();
        const std::uint8_t* bytes = transfer->buffer;
        for (int i = 0; i < transfer->num_iso_packets; ++i) {
            const libusb_iso_packet_descriptor& packet = transfer->iso_packet_desc[i];
            batch.push_back(
                {{bytes, packet.actual_length}, packet.status == LIBUSB_TRANSFER_COMPLETED});
            bytes += packet.length;
        }
        if (sink) sink->packets(batch, now_ns());
    }

    void came_back(libusb_transfer* transfer) {
        if (!ending) {
            switch (transfer->status) {
                case LIBUSB_TRANSFER_COMPLETED:
                    failures = 0;
                    hand_on(transfer);
                    break;
                case LIBUSB_TRANSFER_NO_DEVICE:
                    end(Failure::no_device, "the sensor was unplugged");
                    break;
                case LIBUSB_TRANSFER_CANCELLED:
                    end(Failure::io, "the system cancelled the sensor's transfers");
                    break;
                default:
                    if (++failures >= kMaxFailures) {
                        end(Failure::io, "the sensor's transfers keep failing");
                    }
                    break;
            }
        }
        if (!ending) {
            const int error = libusb_submit_transfer(transfer);
            if (error == 0) return;
            const Failure kind = failure_of(error);
            end(kind, kind == Failure::no_device ? "the sensor was unplugged"
                                                 : "the system takes no more transfers");
        }
        --pending;
        retired.notify_all();
    }
};

void LIBUSB_CALL on_transfer(libusb_transfer* transfer) {
    auto* state = static_cast<StreamState*>(transfer->user_data);
    const std::lock_guard lock(state->mutex);
    state->came_back(transfer);
}

class LibusbStream : public IsoStream {
  public:
    explicit LibusbStream(std::shared_ptr<StreamState> state) : state_(std::move(state)) {}
    ~LibusbStream() override {
        std::unique_lock lock(state_->mutex);
        state_->ending = true;
        // Cancelling calls nothing back from here; that happens on the event thread.
        for (libusb_transfer* transfer : state_->transfers) libusb_cancel_transfer(transfer);
        const bool all_back =
            state_->retired.wait_for(lock, kStopPatience, [this] { return state_->pending == 0; });
        state_->sink = nullptr;
        if (!all_back) state_->kept_alive = state_;
    }

  private:
    std::shared_ptr<StreamState> state_;
};

}  // namespace

Outcome<std::unique_ptr<IsoStream>> start_libusb_stream(libusb_device_handle* handle,
                                                        const IsoParameters& parameters,
                                                        PacketSink& sink) {
    auto state = std::make_shared<StreamState>();
    state->sink = &sink;
    state->parameters = parameters;
    const int transfer_bytes = parameters.packets_per_transfer * parameters.packet_bytes;
    state->buffer.resize(static_cast<std::size_t>(parameters.transfers) *
                         static_cast<std::size_t>(transfer_bytes));
    for (int i = 0; i < parameters.transfers; ++i) {
        libusb_transfer* transfer = libusb_alloc_transfer(parameters.packets_per_transfer);
        if (!transfer) return fault(Failure::no_memory, "no memory for transfers");
        state->transfers.push_back(transfer);
        libusb_fill_iso_transfer(transfer, handle, parameters.endpoint,
                                 state->buffer.data() + std::ptrdiff_t{i} * transfer_bytes,
                                 transfer_bytes, parameters.packets_per_transfer, on_transfer,
                                 state.get(), 0);
        libusb_set_iso_packet_lengths(transfer, static_cast<unsigned>(parameters.packet_bytes));
    }
    auto stream = std::make_unique<LibusbStream>(state);
    for (libusb_transfer* transfer : state->transfers) {
        const std::lock_guard lock(state->mutex);
        if (state->ending) break;
        const int error = libusb_submit_transfer(transfer);
        if (error != 0) {
            state->sink = nullptr;
            return libusb_fault(error, fmt::format("the stream of endpoint 0x{:02x} does not start",
                                                   parameters.endpoint));
        }
        ++state->pending;
    }
    return stream;
}

}  // namespace kino::usb
