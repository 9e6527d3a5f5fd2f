// Sending: an address goes to somebody by what a device has for that, or onto the clipboard.
const byFinger = matchMedia('(hover: none)');

/** Whether an address is on the clipboard now.
 * @type {(address: string) => Promise<boolean>} */
export const copied = async (address) => Boolean(await navigator.clipboard?.writeText(address).then(() => true, () => false));

/** Whether the device has asked to whom it is to go; who thinks better of it is told nothing.
 * @type {(title: string, url: string) => Promise<boolean>} */
export async function shared(title, url) {
  if (!navigator.share || !byFinger.matches) return false;
  await navigator.share({ title, url }).catch(() => {});
  return true;
}

// What a page of ranks does: its buttons send races.
export function ranked() {
  const place = document.getElementById('said');
  /** @type {NodeListOf<HTMLElement>} */
  const buttons = document.querySelectorAll('[data-race]');
  for (const button of buttons) button.addEventListener('click', async () => {
    const url = new URL(button.dataset.race ?? '', location.href).href;
    if (await shared(document.title, url)) return;
    place?.replaceChildren(await copied(url) ? 'The link is copied: whoever opens it races this run.' : url);
  });
}
