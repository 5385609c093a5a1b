//! Frames in, detections out: ArUco markers, hands, calibration.
