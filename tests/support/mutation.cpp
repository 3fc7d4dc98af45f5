#include "tests/support/mutation.h"

#include <algorithm>

namespace kino::test {

void damage(std::vector<std::uint8_t>& bytes, std::mt19937& random, std::size_t head) {
    if (bytes.empty()) return;
    const std::size_t range =
        random() % 2 == 0 ? std::min<std::size_t>(bytes.size(), head) : bytes.size();
    const std::size_t at = random() % range;
    const auto place = bytes.begin() + static_cast<std::ptrdiff_t>(at);
    switch (random() % 6) {
        case 0:
            *place = static_cast<std::uint8_t>(random());
            break;
        case 1:
            *place ^= static_cast<std::uint8_t>(1U << random() % 8);
            break;
        case 2:
            std::fill_n(place, std::min<std::size_t>(bytes.size() - at, 1 + random() % 4),
                        random() % 2 == 0 ? 0xFF : 0);
            break;
        case 3:
            bytes.resize(at);
            break;
        case 4: {
            const std::size_t length = std::min<std::size_t>(bytes.size() - at, random() % 30);
            bytes.erase(place, place + static_cast<std::ptrdiff_t>(length));
            break;
        }
        default: {
            const std::size_t length = std::min<std::size_t>(bytes.size() - at, random() % 60);
            const std::vector<std::uint8_t> copy(place,
                                                 place + static_cast<std::ptrdiff_t>(length));
            bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(random() % bytes.size()),
                         copy.begin(), copy.end());
        }
    }
}

}  // namespace kino::test
