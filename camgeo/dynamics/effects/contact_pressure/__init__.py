"""Effect `contact-pressure`: Hertzian pressure between cam and follower."""
