// Words of the viewer alone.

export const VIEWER_WORDS = {
  extremes: "Extremes as a table",
  extremesOf: ["curve", "smallest", "at", "largest", "at"],
};
