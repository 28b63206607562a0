# Copyright 2026 lsc_pose_ros contributors
# SPDX-License-Identifier: Apache-2.0
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""Whether a camera sees a joint, or what hides it."""

SEEN = 0
"""The image shows the skin near the joint, of the joint's own body part."""

HIDDEN_BY_BODY = 1
"""The person's own body hides the joint's body part, or it is turned away from the camera."""

HIDDEN = 2
"""Something else hides the joint's body part, or the sensor measures nothing there."""

OUTSIDE = 3
"""The joint is outside of the image, or in a margin in which the sensor measures nothing."""

UNKNOWN = 255
"""The ground truth does not tell."""

VISIBILITIES = {
    SEEN: 'seen',
    HIDDEN_BY_BODY: 'hidden by the body',
    HIDDEN: 'hidden by something else',
    OUTSIDE: 'outside of the image',
}
"""What users call each of them."""
