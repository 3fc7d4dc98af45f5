#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>

#include "base/check.h"

// tinygltf's own readers of pictures and files are not wanted.
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_FS
#include <tiny_gltf.h>

namespace kino {

/// The numbers of one accessor of a checked file.
class GltfNumbers {
  public:
    GltfNumbers(const tinygltf::Model& model, int accessor_index) {
        const auto& accessor = model.accessors.at(static_cast<std::size_t>(accessor_index));
        const auto& view = model.bufferViews.at(static_cast<std::size_t>(accessor.bufferView));
        const auto& buffer = model.buffers.at(static_cast<std::size_t>(view.buffer));
        parts_ = static_cast<std::size_t>(
            tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type)));
        component_ = accessor.componentType;
        normalized_ = accessor.normalized;
        count_ = accessor.count;
        bytes_ = static_cast<std::size_t>(
            tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(component_)));
        stride_ = view.byteStride != 0 ? view.byteStride : parts_ * bytes_;
        const std::size_t offset = view.byteOffset + accessor.byteOffset;
        // check_gltf() has seen to it.
        KINO_CHECK(count_ > 0 &&
                   offset + (count_ - 1) * stride_ + parts_ * bytes_ <= buffer.data.size());
        data_ = buffer.data.data() + offset;
    }

    [[nodiscard]] std::size_t count() const { return count_; }
    [[nodiscard]] std::size_t parts() const { return parts_; }
    [[nodiscard]] bool is_float() const { return component_ == TINYGLTF_COMPONENT_TYPE_FLOAT; }
    [[nodiscard]] bool is_unsigned() const {
        return component_ == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
               component_ == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
               component_ == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    }

    /// Part `part` of element `element`, as the whole number it is.
    [[nodiscard]] std::uint32_t whole(std::size_t element, std::size_t part = 0) const {
        const std::uint8_t* at = data_ + element * stride_ + part * bytes_;
        if (component_ == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE) return *at;
        if (component_ == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT) {
            return read<std::uint16_t>(at);
        }
        return read<std::uint32_t>(at);
    }

    /// The same as a number; `normalized` integers in -1 .. 1 or 0 .. 1.
    [[nodiscard]] double at(std::size_t element, std::size_t part) const {
        const std::uint8_t* where = data_ + element * stride_ + part * bytes_;
        switch (component_) {
            case TINYGLTF_COMPONENT_TYPE_FLOAT:
                return read<float>(where);
            case TINYGLTF_COMPONENT_TYPE_BYTE:
                return scaled(read<std::int8_t>(where));
            case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
                return scaled(read<std::uint8_t>(where));
            case TINYGLTF_COMPONENT_TYPE_SHORT:
                return scaled(read<std::int16_t>(where));
            case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
                return scaled(read<std::uint16_t>(where));
            default:
                return read<std::uint32_t>(where);
        }
    }

  private:
    /// Offsets in files need not be aligned.
    template <class T>
    static T read(const std::uint8_t* from) {
        T value;
        std::memcpy(&value, from, sizeof(T));
        return value;
    }
    template <class T>
    [[nodiscard]] double scaled(T value) const {
        if (!normalized_) return value;
        const double v = value / static_cast<double>(std::numeric_limits<T>::max());
        return v < -1 ? -1 : v;
    }

    const std::uint8_t* data_ = nullptr;
    std::size_t count_ = 0;
    std::size_t parts_ = 0;
    std::size_t bytes_ = 0;
    std::size_t stride_ = 0;
    int component_ = 0;
    bool normalized_ = false;
};

}  // namespace kino
