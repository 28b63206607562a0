"""Files that come with the package: configuration, models, the body, and how they are found."""
