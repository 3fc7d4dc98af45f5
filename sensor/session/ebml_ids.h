#pragma once

#include <cstdint>

/// The element IDs of EBML (RFC 8794) and Matroska (RFC 9559) that sessions use, marker bits in.
namespace kino::ebml {

enum Id : std::uint32_t {
    kEbml = 0x1A45DFA3,
    kEbmlVersion = 0x4286,
    kEbmlReadVersion = 0x42F7,
    kEbmlMaxIdLength = 0x42F2,
    kEbmlMaxSizeLength = 0x42F3,
    kDocType = 0x4282,
    kDocTypeVersion = 0x4287,
    kDocTypeReadVersion = 0x4285,
    kVoid = 0xEC,
    kCrc32 = 0xBF,

    kSegment = 0x18538067,
    kSeekHead = 0x114D9B74,
    kSeek = 0x4DBB,
    kSeekId = 0x53AB,
    kSeekPosition = 0x53AC,

    kInfo = 0x1549A966,
    kTimestampScale = 0x2AD7B1,
    kDuration = 0x4489,
    kDateUtc = 0x4461,
    kMuxingApp = 0x4D80,
    kWritingApp = 0x5741,

    kTracks = 0x1654AE6B,
    kTrackEntry = 0xAE,
    kTrackNumber = 0xD7,
    kTrackUid = 0x73C5,
    kTrackType = 0x83,
    kFlagDefault = 0x88,
    kFlagLacing = 0x9C,
    kDefaultDuration = 0x23E383,
    kMaxBlockAdditionId = 0x55EE,
    kBlockAdditionMapping = 0x41E4,
    kBlockAddIdValue = 0x41F0,
    kBlockAddIdName = 0x41A4,
    kBlockAddIdType = 0x41E7,
    kTrackName = 0x536E,
    kLanguage = 0x22B59C,
    kCodecId = 0x86,
    kCodecPrivate = 0x63A2,
    kContentEncodings = 0x6D80,
    kVideo = 0xE0,
    kFlagInterlaced = 0x9A,
    kPixelWidth = 0xB0,
    kPixelHeight = 0xBA,
    kColourSpace = 0x2EB524,

    kAttachments = 0x1941A469,
    kAttachedFile = 0x61A7,
    kFileDescription = 0x467E,
    kFileName = 0x466E,
    kFileMediaType = 0x4660,
    kFileData = 0x465C,
    kFileUid = 0x46AE,

    kTags = 0x1254C367,
    kTag = 0x7373,
    kTargets = 0x63C0,
    kTargetTypeValue = 0x68CA,
    kTagTrackUid = 0x63C5,
    kSimpleTag = 0x67C8,
    kTagName = 0x45A3,
    kTagString = 0x4487,

    kCluster = 0x1F43B675,
    kTimestamp = 0xE7,
    kSimpleBlock = 0xA3,
    kBlockGroup = 0xA0,
    kBlock = 0xA1,
    kBlockDuration = 0x9B,
    kBlockAdditions = 0x75A1,
    kBlockMore = 0xA6,
    kBlockAddId = 0xEE,
    kBlockAdditional = 0xA5,

    kCues = 0x1C53BB6B,
    kCuePoint = 0xBB,
    kCueTime = 0xB3,
    kCueTrackPositions = 0xB7,
    kCueTrack = 0xF7,
    kCueClusterPosition = 0xF1,
};

}  // namespace kino::ebml
