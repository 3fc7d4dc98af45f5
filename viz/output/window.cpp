#include "viz/output/window.h"

#include "viz/output/swapchain.h"
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <utility>

#include "base/check.h"

namespace kino {
namespace {

std::string glfw_problem() {
    const char* text = nullptr;
    glfwGetError(&text);
    return text != nullptr ? text : "unknown reason";
}

}  // namespace

struct Window::State {
    ~State() {
        if (window != nullptr) glfwDestroyWindow(window);
        glfwTerminate();
    }
    [[nodiscard]] glm::dvec2 to_picture(double x, double y) const {
        int width = 0, height = 0, picture_width = 0, picture_height = 0;
        glfwGetWindowSize(window, &width, &height);
        glfwGetFramebufferSize(window, &picture_width, &picture_height);
        if (width <= 0 || height <= 0) return {x, y};
        return {x * picture_width / width, y * picture_height / height};
    }
    static State& of(GLFWwindow* window) {
        return *static_cast<State*>(glfwGetWindowUserPointer(window));
    }

    GLFWwindow* window = nullptr;
    WindowInput input;
    gpu::Device* device = nullptr;
    VkSurfaceKHR surface = VK_NULL_HANDLE;
    PresentMode present = PresentMode::fifo;
    std::unique_ptr<Swapchain> swapchain;
};

Window::Window(std::unique_ptr<State> state) : state_(std::move(state)) {}
Window::~Window() {
    detach();
}

Result<std::unique_ptr<Window>> Window::open(const WindowOptions& options) {
    if (glfwInit() != GLFW_TRUE) {
        return fail("no window can be opened: " + glfw_problem(), {},
                    "without a display, use --headless FOLDER");
    }
    auto state = std::make_unique<State>();
    if (glfwVulkanSupported() != GLFW_TRUE) {
        return fail("no Vulkan driver can draw into windows here");
    }
    glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
    state->window =
        glfwCreateWindow(options.width, options.height, options.title.c_str(), nullptr, nullptr);
    if (state->window == nullptr) {
        return fail("no window can be opened: " + glfw_problem(), {},
                    "without a display, use --headless FOLDER");
    }
    state->present = options.present;
    glfwSetWindowUserPointer(state->window, state.get());
    glfwSetKeyCallback(state->window, [](GLFWwindow* w, int key, int, int action, int mods) {
        if (action == GLFW_RELEASE) return;
        State::of(w).input.keys.push_back({.key = key,
                                           .shift = (mods & GLFW_MOD_SHIFT) != 0,
                                           .control = (mods & GLFW_MOD_CONTROL) != 0,
                                           .repeat = action == GLFW_REPEAT});
    });
    glfwSetMouseButtonCallback(state->window, [](GLFWwindow* w, int button, int action, int) {
        double x = 0, y = 0;
        glfwGetCursorPos(w, &x, &y);
        State& s = State::of(w);
        s.input.buttons.push_back(
            {.button = button, .down = action == GLFW_PRESS, .at = s.to_picture(x, y)});
    });
    glfwSetScrollCallback(state->window, [](GLFWwindow* w, double x, double y) {
        State::of(w).input.scroll += glm::dvec2(x, y);
    });
    glfwSetDropCallback(state->window, [](GLFWwindow* w, int count, const char** paths) {
        for (int i = 0; i < count; ++i) State::of(w).input.dropped.emplace_back(paths[i]);
    });
    return std::unique_ptr<Window>(new Window(std::move(state)));
}

std::vector<std::string> Window::instance_extensions() const {
    std::uint32_t count = 0;
    const char** names = glfwGetRequiredInstanceExtensions(&count);
    return names == nullptr ? std::vector<std::string>()
                            : std::vector<std::string>(names, names + count);
}

Result<void> Window::attach(gpu::Device& device) {
    KINO_CHECK(state_->device == nullptr);
    KINO_VK_TRY(
        glfwCreateWindowSurface(device.instance(), state_->window, nullptr, &state_->surface),
        "making the window's surface");
    state_->device = &device;
    VkBool32 can_present = VK_FALSE;
    KINO_VK_TRY(vkGetPhysicalDeviceSurfaceSupportKHR(device.physical(), device.queue_family(),
                                                     state_->surface, &can_present),
                "asking whether the device can present");
    if (can_present != VK_TRUE) {
        return fail("this device cannot draw into this window", device.info().name,
                    "choose another with --device; kinoscope devices lists them");
    }
    state_->swapchain = std::make_unique<Swapchain>(device, state_->surface, state_->present);
    return {};
}

void Window::detach() {
    if (state_->device == nullptr) return;
    state_->swapchain.reset();
    vkDestroySurfaceKHR(state_->device->instance(), state_->surface, nullptr);
    state_->surface = VK_NULL_HANDLE;
    state_->device = nullptr;
}

bool Window::should_close() const {
    return glfwWindowShouldClose(state_->window) != 0;
}
void Window::close() {
    glfwSetWindowShouldClose(state_->window, GLFW_TRUE);
}
void Window::set_title(const std::string& title) {
    glfwSetWindowTitle(state_->window, title.c_str());
}

WindowInput Window::poll(TimeNs timeout) {
    if (timeout > 0) {
        glfwWaitEventsTimeout(to_seconds(timeout));
    } else {
        glfwPollEvents();
    }
    double x = 0, y = 0;
    glfwGetCursorPos(state_->window, &x, &y);
    state_->input.cursor_px = state_->to_picture(x, y);
    return std::exchange(state_->input, {});
}

bool Window::is_key_down(int key) const {
    return glfwGetKey(state_->window, key) == GLFW_PRESS;
}
bool Window::is_button_down(int button) const {
    return glfwGetMouseButton(state_->window, button) == GLFW_PRESS;
}

bool Window::minimised() const {
    int width = 0, height = 0;
    glfwGetFramebufferSize(state_->window, &width, &height);
    return width <= 0 || height <= 0 || glfwGetWindowAttrib(state_->window, GLFW_ICONIFIED) != 0;
}

void Window::capture_cursor(bool capture) {
    glfwSetInputMode(state_->window, GLFW_CURSOR,
                     capture ? GLFW_CURSOR_DISABLED : GLFW_CURSOR_NORMAL);
}

Result<std::optional<PictureTarget>> Window::begin_picture() {
    KINO_CHECK(state_->swapchain != nullptr);
    if (minimised()) return std::nullopt;
    int width = 0, height = 0;
    glfwGetFramebufferSize(state_->window, &width, &height);
    return state_->swapchain->acquire(
        {static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height)});
}

Result<void> Window::present() {
    return state_->swapchain->present();
}

PresentMode Window::present_mode() const {
    return state_->swapchain == nullptr ? state_->present : state_->swapchain->mode();
}

GLFWwindow* Window::handle() const {
    return state_->window;
}

}  // namespace kino
