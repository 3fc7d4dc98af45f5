// A number that stands for an object and its material beside light: a half float holds it, and
// what is packed with light needs no fetch of its own. Numbers of two of 2048 objects may agree.
float object_tag(uint object) { return float((object ^ (object >> 16) * 73u) & 2047u); }
