-- Every content that a robot ever had.
CREATE TABLE revision (
    robot_id TEXT NOT NULL,
    revision TEXT NOT NULL,
    description BLOB NOT NULL,
    summary BLOB NOT NULL,
    PRIMARY KEY (robot_id, revision)
);
-- When which of them became current.
CREATE TABLE registration (
    sequence INTEGER PRIMARY KEY AUTOINCREMENT,
    robot_id TEXT NOT NULL,
    revision TEXT NOT NULL,
    FOREIGN KEY (robot_id, revision) REFERENCES revision (robot_id, revision)
);
CREATE INDEX registration_of_robot ON registration (robot_id, sequence);
-- Which of them is current.
CREATE TABLE robot (
    robot_id TEXT NOT NULL PRIMARY KEY,
    revision TEXT NOT NULL,
    FOREIGN KEY (robot_id, revision) REFERENCES revision (robot_id, revision)
);
PRAGMA user_version = 1;
