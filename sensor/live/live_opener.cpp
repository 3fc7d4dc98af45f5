#include <utility>

#include "sensor/live/live_source.h"

namespace kino {

SourceOpener live_opener(DeviceDriver driver) {
    SourceOpener opener;
    opener.name = driver.name;
    opener.uri_pattern = driver.uri_pattern;
    const std::string prefix = driver.scheme + ":";
    opener.probe = [prefix](const std::string& uri) { return uri.starts_with(prefix); };
    opener.list = [driver] {
        std::vector<std::string> uris;
        if (!driver.list) return uris;
        for (DeviceEntry& entry : driver.list()) {
            if (entry.problem.empty()) uris.push_back(std::move(entry.uri));
        }
        return uris;
    };
    opener.open = [driver, prefix](const std::string& uri) -> Result<std::unique_ptr<Source>> {
        return make_live_source(driver, uri.substr(prefix.size()));
    };
    return opener;
}

}  // namespace kino
